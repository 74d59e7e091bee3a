"""Programs in Python that are part of a build, such as setup.py and `.cfg` files, run for the calls that they make."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.extract.python.language import Python
from kg.extract.python.modules import Modules
from kg.symbolic.descriptions import Descriptions
from kg.symbolic.effects import Framework
from kg.symbolic.machine import Machine
from kg.symbolic.values import Kind, Mapping, Object, Sequence, Text, Value, alternatives

if TYPE_CHECKING:
    from collections.abc import Mapping as Names

    from kg.corpus.files import FilePath
    from kg.corpus.reading import Reader
    from kg.symbolic.state import Arguments


@dataclass(frozen=True, slots=True)
class Called:
    """A call of a function or method that is not in the build: its name, what it is given, and where it is written."""

    name: str
    values: list[Value]
    named: Names[str, Value]
    file: FilePath
    line: int


class _Recorder(Framework):
    """Records the calls of everything that is not in the build. A method may return the object that it is called on.

    The files that `glob` finds are its pattern.
    """

    def __init__(self) -> None:
        super().__init__(Descriptions("python"))
        self.calls: list[Called] = []

    def construct(self, kind: Kind, given: Arguments) -> Value | None:
        """Record the call of a class or function."""
        self._record(kind.name, given)
        return Sequence(tuple(given.values[:1])) if kind.name == "glob" else None

    def call_method(self, of: Object, name: str, given: Arguments) -> Value | None:
        """Record the call of a method."""
        self._record(name, given)
        return of

    def progress(self) -> tuple[int, ...]:
        """Return the number of calls: a function that makes one has effects."""
        return (len(self.calls),)

    def _record(self, name: str, given: Arguments) -> None:
        if given.frame is not None and given.call is not None:
            self.calls.append(Called(name, given.values, given.named, given.frame.unit.key, given.call.line))


class _Modules(Modules):
    def starred(self, name: str, modules: list[str]) -> tuple[str, ...] | None:
        """Return the full name of what `from module import *` gives, which can be anything."""
        return (*modules[0].split("."), name)


def calls_of(reader: Reader, file: FilePath) -> list[Called]:
    """Return the calls that a program makes, in order; what does not parse is a problem KG115 of the `reader`."""
    modules = _Modules(reader, reader.package)
    unit = modules.unit(file)
    if unit is None:
        return []
    language, recorder = Python(modules, unit), _Recorder()
    language.machine = recorder.machine = Machine(language, recorder)
    language.module(unit)
    return recorder.calls


def lines(value: Value | None) -> list[str]:
    """Return the lines of a known text, or of all texts in a list."""
    result: list[str] = []
    for one in alternatives(value) if value is not None else ():
        if isinstance(one, Sequence):
            result += [line for item in one.items for line in lines(item)]
        elif isinstance(one, Text) and one.exact is not None:
            result += one.exact.splitlines()
    return result


def entries(value: Value | None) -> dict[str, Value]:
    """Return the entries of a dictionary whose keys are known texts; none of other values."""
    pairs = [pair for one in alternatives(value) if isinstance(one, Mapping) for pair in one.items] if value else []
    return {key.exact: item for key, item in pairs if isinstance(key, Text) and key.exact is not None}
