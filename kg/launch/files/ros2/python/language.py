"""The meaning of names, members, elements and calls in launch files, in addition to that in all Python.

A class or function outside of the build is known by its name (`kg.launch.files.ros2.python.library`), or not run.
"""

from __future__ import annotations

import posixpath
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.extract.constants import Constants
from kg.extract.python.calls import Calls
from kg.extract.python.language import Python
from kg.extract.python.modules import BUILTINS, PythonUnit
from kg.extract.python.paths import METHODS
from kg.launch.files.ros2.context import HOLE
from kg.launch.files.ros2.python import library
from kg.launch.files.ros2.python.values import Instance, later, launch_text, reason_of, text_of
from kg.symbolic.operators import NULL, plain
from kg.symbolic.state import Arguments, Frame
from kg.symbolic.values import (
    Bound,
    Closure,
    Kind,
    Mapping,
    Number,
    Object,
    Pack,
    Sequence,
    Text,
    TypeValue,
    Unknown,
    Value,
    number,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.launch.files.access import Files
    from kg.launch.files.ros2.actions import Substitution
    from kg.launch.files.ros2.python.machine import LaunchMachine
    from kg.launch.files.ros2.python.reading import Reading
    from kg.symbolic import form
    from kg.symbolic.form import Expression

_REMEMBERED = 256


@lru_cache(maxsize=_REMEMBERED)
def parse(file: FilePath, text: bytes) -> PythonUnit:
    """Return the form of a Python file."""
    return PythonUnit(file, text, {})


_OUTSIDE: Final = frozenset(
    {
        "launch", "launch_ros", "launch_testing", "launch_xml", "launch_yaml", "launch_param_builder",
        "ament_index_python", "os", "sys", "pathlib", "typing", "yaml", "json", "xacro", "nav2_common", "rclpy",
        "lifecycle_msgs", "moveit_configs_utils", "math", "subprocess", "tempfile", "copy", "re", "dataclasses",
        "enum", "unittest", "pytest", "__future__", "collections", "functools", "itertools", "random", "shutil",
        "time", "logging", "ast", "glob",
    }
)  # fmt: skip
"""First names of modules that are never looked for in the build: the tables know them, or nobody does."""
_MODEL: Final = ("pydantic", "BaseModel")
_PLAIN_BASES: Final = frozenset({"builtins", "abc", "enum", "typing"})


class LaunchModules:
    """The modules that a launch file sees."""

    def __init__(self, files: Files) -> None:
        self.files = files
        self.constants = Constants(files.reader)

    def unit(self, file: FilePath) -> PythonUnit | None:
        """Return a module; None if it cannot be read."""
        content = self.files.read(file)
        unit = parse(file, content) if content is not None else None
        return unit if unit is not None and unit.error is None else None

    def find(self, dotted: str, unit: PythonUnit) -> PythonUnit | None:
        """Return a module as imported in a file: of the build, or next to the file."""
        if dotted.partition(".")[0] in _OUTSIDE or not dotted.strip("."):
            return None
        file = self.files.reader.workspace.module(dotted, near=unit.key)
        path = posixpath.join(posixpath.dirname(unit.key.path), f"{dotted.lstrip('.')}.py")
        sibling = FilePath(unit.key.repository, path)
        if file is None and self.files.exists(sibling):
            file = sibling  # launch files often extend the search path by their own folder
        if file is None and b"sys.path" in unit.source:
            owner = self.files.reader.workspace.owner(unit.key)
            file = self.files.likely(owner, f"{dotted.lstrip('.').replace('.', '/')}.py") if owner else None
        return self.unit(file) if file is not None and file != unit.key else None

    def starred(self, name: str, modules: Iterable[str]) -> tuple[str, ...] | None:
        """Return the full name of what `from module import *` gives."""
        module = next((one for one in modules if one.startswith("launch")), None)
        return (*module.split("."), name) if module is not None and name in library.NAMES else None


class LaunchCalls(Calls):
    """The calls of a launch file."""

    _language: LaunchPython

    def method(self, of: Value, name: str, given: Arguments, written: Expression | None = None) -> Value:
        """Call a method of a value."""
        if isinstance(of, Text) and name in library.PATH_METHODS:
            return library.PATH_METHODS[name](self._language, of)
        if isinstance(of, Text) and name in ("glob", "iterdir"):
            return library.found_below(self._language, of, given)
        if isinstance(of, Text) and name not in ("join", "format"):
            of = self._language.resolved(of)
            if isinstance(of, Text) and of.exact is None and name not in METHODS:
                return Unknown(reason_of(of))
        if isinstance(of, Unknown):
            return Unknown(of.reason)
        if isinstance(of, Sequence):
            given = replace(given, values=[self._language.machine.flattened(value) for value in given.values])
        result = super().method(of, name, given, written)
        if isinstance(result, Unknown) and result.reason.endswith("in the sources that were read"):
            return Unknown(reason_of(of) if isinstance(of, Text | Instance) else f"`{name}()`: {reason_of(of)}")
        return result

    def outside_method(self, of: Object, name: str, given: Arguments) -> Value:
        """Call a method of an object that is not of the build."""
        if isinstance(of, Instance):
            if name == "__init__" and of.kind.cls is not None:
                library.initialise(of, given)
                return NULL
            return library.method(self._language, of, name, given)
        return super().outside_method(of, name, given)

    def outside(self, called: TypeValue, given: Arguments) -> Value:
        """Call a function or class that is not in the build."""
        path = ".".join(called.kind.names)
        return library.call(self._language, called.kind, given) or Unknown(
            f"`{path.removeprefix('builtins.')}()` is not run"
        )

    def escape(self, values: Iterable[Value]) -> None:
        """Do nothing: code outside of the build calls no functions that matter."""

    def construct(self, kind: Kind, given: Arguments, *, hosted: bool = False) -> Object:
        """Return a new object of a class of the build, also of one that extends a class of launch.

        With another base outside of the build it is unknown.
        """
        bases = [one for one in self._language.chain(kind)[1] if one.names[0] not in _PLAIN_BASES]
        if not bases:
            return super().construct(kind, given, hosted=hosted)
        if all(one.names == _MODEL for one in bases):
            return self._model(kind, super().construct(kind, given, hosted=hosted))
        base = next((one for one in bases if one.names[0] in _OUTSIDE and one.name in library.EXTENDED), None)
        if base is None:
            return Unknown(f"the class `{kind.name}` has a base that is not in the build")  # type: ignore[return-value]  # as any value
        return self._extending(kind, base, given)

    def _model(self, kind: Kind, made: Object) -> Object:
        """Return an object of a class of pydantic as its validators of all fields leave it."""
        classes = [cls for cls, _ in self._language.chain(kind)[0]]
        for cls in classes:
            for name in cls.fields:
                if isinstance(self._language.of_object(made, name), Bound):
                    made.fields[name] = NULL  # of the type `Optional`, or its absence is an error
            for function in (one[0] for one in cls.methods.values() if "root_validator" in one[0].marks):
                fields = dict.fromkeys(name for one in classes for name in one.fields)
                values = tuple((Text.of(name), self._language.of_object(made, name)) for name in fields)
                closure = Closure(function, self._language.around[cls], (TypeValue(kind),))
                result = self.value(closure, Arguments([Mapping(values)]))
                if not isinstance(result, Mapping):
                    return Unknown("a validator decides about its fields")  # type: ignore[return-value]  # as any value
                made.fields.update(
                    (one.exact, value) for one, value in result.items if isinstance(one, Text) and one.exact
                )
        return made

    def _extending(self, kind: Kind, base: Kind, given: Arguments) -> Instance:
        """Return an object of a class of the build that extends `base`, a class of launch."""
        language = self._language
        made = library.create(language, base.name, {}, given)
        made.kind = replace(made.kind, cls=kind.cls)
        owner = next((one for one, _ in language.chain(kind)[0] if "__init__" in one.methods), None)
        if owner is None:
            library.initialise(made, given)
        else:
            self._initialise(Closure(owner.methods["__init__"][0], language.around[owner], (made,)), given)
        made.given = Arguments(made.given.values, named=made.given.named)  # the words of the call are not its own
        if base.name == "Action":
            made.kind = replace(made.kind, names=("launch", "OpaqueFunction"))
            made.fields["function"] = language.of_object(made, "execute")
        return made


class LaunchPython(Python):
    """The meaning of a launch file; `reading` is what reads it."""

    machine: LaunchMachine
    calls: LaunchCalls
    calls_of = LaunchCalls

    def __init__(self, reading: Reading) -> None:
        super().__init__(LaunchModules(reading.files))  # type: ignore[arg-type]  # they find modules in another way
        self.reading = reading

    def path_of(self, unit: PythonUnit) -> Value:
        """Return the path of a module."""
        return Text.of(self.reading.files.text(unit.key))

    def name(self, expression: form.Name, frame: Frame) -> Value:
        """Return the meaning of a name that is not a variable."""
        value = super().name(expression, frame)
        if isinstance(value, Unknown) and expression.names[-1] not in BUILTINS:
            return Unknown(f"the name `{expression.names[-1]}` is not bound to anything known")
        return value

    def unknown(self, kind: form.Type | None, frame: Frame, name: str) -> Value:
        """Return an argument that a call does not give."""
        del kind
        return Unknown(f"the argument `{name}` of `{frame.scope[-1]}` is not given")

    def member(self, of: Value, name: str) -> Value:
        """Return a member of a value."""
        if isinstance(of, Unknown):
            return of
        if isinstance(of, Instance) and of.kind.cls is None:
            return of.fields[name] if name in of.fields else Bound(name, of)
        if isinstance(of, Object | TypeValue | Text):
            return super().member(of, name)
        return Unknown(f"the attribute `{name}`: {reason_of(of)}")

    def _constant(self, constant: TypeValue) -> Value:
        return Unknown("the command line") if constant.kind.names == ("sys", "argv") else super()._constant(constant)

    # Elements

    def element(self, of: Value, key: Value) -> Value:
        """Return the element of a container at a key."""
        key = self.resolved(key)
        if isinstance(of, TypeValue) and of.kind.names == ("os", "environ"):
            return self.resolved(later("env", launch_text(key)))
        if isinstance(of, Instance):
            return self.configuration(of, key)
        if isinstance(of, Unknown) or isinstance(key, Unknown):
            return Unknown(reason_of(of if isinstance(of, Unknown) else key))
        if isinstance(of, Mapping | Sequence) and plain(key) is None:
            return Unknown(f"an element: {reason_of(key)}")
        value = super().element(of, key)
        if isinstance(of, Mapping) and of.open and isinstance(value, Unknown):
            return Unknown("there may be more entries")
        return value

    def with_element(self, of: Value, key: Value, value: Value) -> Value:
        """Return a container with an element set."""
        if isinstance(of, Sequence) and of.items and isinstance(key, Number) and key.value < 0:
            key = number(len(of.items) + key.value)
        if isinstance(of, Mapping) and isinstance(key, Unknown):
            return Mapping(of.items, open=True, default=of.default)
        return super().with_element(of, key, value)

    def configuration(self, of: Instance, key: Value) -> Value:
        """Return `context.launch_configurations[key]`."""
        context, name = self.reading.context, plain(key)
        if of.name != library.CONFIGURATIONS or context is None or not isinstance(name, str):
            return Unknown("a launch configuration is read where none is known")
        value = context.configuration(name)
        if value is None:
            return Unknown(f"the launch configuration `{name}` is not set")
        return library.with_holes(value, f"the launch configuration `{name}` is not known")

    def configure(self, of: Instance, key: Value, value: Value) -> None:
        """Run `context.launch_configurations[key] = value`."""
        context, name = self.reading.context, plain(self.resolved(key))
        if of.name == library.CONFIGURATIONS and context is not None and isinstance(name, str):
            guards = self.machine.guards
            setting = Unknown(f"it depends on `{guards[-1].lstrip('!?')}`") if guards else value
            context.scope.configurations[name] = context.perform(launch_text(setting))

    def _spread(self, expression: form.Spread, frame: Frame) -> Value:
        """Return the elements of a collection as items of another one."""
        value = self.machine.value(expression.of, frame)
        items = self.machine.items(value)
        if items is None:
            return Unknown(reason_of(value))
        return Pack(tuple(self.machine.under(item, terms) for item, terms in items))

    # Texts

    def resolved(self, value: Value) -> Value:
        """Return a text with variables of the environment as far as they are known now, else by their defaults."""
        from kg.launch.files.ros2.python.machine import resolve_text  # noqa: PLC0415 - each needs the other

        return resolve_text(value, self._perform_variable)

    def _perform_variable(self, part: Substitution) -> str | None:
        if part.kind != "env":
            return None
        if self.reading.context is not None:
            performed = self.reading.context.perform((part,))
            return None if HOLE in performed else performed
        name = text_of(part.arguments[0]).exact
        value = self.reading.variable(name) if name is not None else None
        if value is not None:
            return None if HOLE in value else value
        default = part.arguments[1] if len(part.arguments) > 1 else None
        return text_of(default).exact if default is not None else None

    def below(self, row: tuple[Value, ...]) -> Value:
        """Return a path below another: of pathlib, or of launch's path substitutions."""
        first, *rest = row
        if isinstance(first, Text):
            return library.joined_path(row)
        value = first.value("substitutions") if isinstance(first, Instance) and first.name.startswith("Path") else None
        parts = value.items if isinstance(value, Sequence) else (value if value is not None else first,)
        return library.create(self, "PathJoinSubstitution", {"substitutions": Sequence((*parts, *rest))})

    def joined(self, row: tuple[Value, ...]) -> Value:
        """Return substitutions and texts in a row as one substitution."""
        return library.create(self, "TextSubstitution", {"text": Sequence(row)})
