"""The scopes of a description: properties, blocks and macros in force at a place, by the rules of xacro.

Properties are evaluated when first used, in their scope. The scope of a macro is within that of its caller, and that of
an included file with a namespace within that of the file that includes it.
Source: wiki.ros.org/xacro, "Properties and Property Blocks", "Macros", "Default parameter values".
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.extract.python.evaluation import HOLE, UnknownValueError
from kg.launch.files.markup import Markup

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from kg.corpus.files import FilePath
    from kg.launch.files.xacro.texts import Texts

_PREFIX: Final = "xacro:"
_OLD_STYLE: Final = {
    "property": {"name"},
    "macro": {"name"},
    "include": {"filename"},
    "insert_block": {"name"},
    "if": {"value"},
    "unless": {"value"},
}
"""Commands that may stand without prefix, with the attributes that tell them from elements of the description."""


@dataclass(slots=True)
class Element:
    """An element; `line` is that of its start tag, `children` are elements and pieces of text in their order."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element | str] = field(default_factory=list)

    @property
    def command(self) -> str | None:
        """The name of the command of xacro that it is, or of the macro that it calls; None for any other element."""
        if self.tag.startswith(_PREFIX):
            return self.tag.removeprefix(_PREFIX)
        needed = _OLD_STYLE.get(self.tag)
        return self.tag if needed is not None and needed <= self.attributes.keys() else None

    def elements(self) -> Iterator[Element]:
        """Yield the elements directly in it."""
        return (child for child in self.children if isinstance(child, Element))


def _text(parent: Element, text: str, _line: int) -> None:
    if not text.isspace():
        parent.children.append(text)


DESCRIPTION: Final = Markup(Element, _text, whole_texts=True, cached=512)
"""The language of robot descriptions."""


_WORDS: Final = {"true": True, "True": True, "false": False, "False": False}
_MOST_DIGITS: Final = 30


@dataclass(frozen=True, slots=True)
class Block:
    """Elements that are inserted elsewhere, and the scope that they are evaluated in; None for that of the place."""

    elements: tuple[Element | str, ...]
    scope: Table | None
    file: FilePath


@dataclass(frozen=True, slots=True)
class Macro:
    """A macro: `parameters` with their defaults, and whether the default is the value that the caller's scope has."""

    name: str
    body: Element
    parameters: dict[str, tuple[bool, str | None] | None]
    file: FilePath


@dataclass(slots=True)
class _Lazy:
    """A text that is evaluated when it is first used."""

    text: str
    busy: bool = False


@dataclass(eq=False, slots=True)
class Table:
    """A scope: properties, blocks and macros by name."""

    evaluate: Callable[[str, Table], object]
    parent: Table | None = None
    spaced: bool = False
    """It is that of a namespace."""
    values: dict[str, object] = field(default_factory=dict)
    blocks: dict[str, Block] = field(default_factory=dict)
    macros: dict[str, Macro] = field(default_factory=dict)

    def __contains__(self, name: str) -> bool:
        """Return whether a property of the name is in force."""
        return self._holder(name) is not None

    def __getitem__(self, name: str) -> object:
        """Return the value of a property; `UnknownValueError` for one that depends on itself, `KeyError` for none."""
        holder = self._holder(name)
        if holder is None:
            raise KeyError(name)
        value = holder.values[name]
        if not isinstance(value, _Lazy):
            return value
        if value.busy:
            raise UnknownValueError
        value.busy = True
        try:
            result = literal(self.evaluate(value.text, holder))
        finally:
            value.busy = False
        holder.values[name] = result
        return result

    def _upwards(self) -> Iterator[Table]:
        """Yield the scope and those around it, the innermost first."""
        table: Table | None = self
        while table is not None:
            yield table
            table = table.parent

    def _holder(self, name: str) -> Table | None:
        return next((table for table in self._upwards() if name in table.values), None)

    def set(self, name: str, value: object, *, lazy: bool = False) -> None:
        """Set a property; a text that is `lazy` and no number or boolean is evaluated later."""
        constant = literal(value)
        self.values[name] = _Lazy(constant) if lazy and isinstance(constant, str) and "$" in constant else constant

    def drop(self, name: str) -> None:
        """Remove a property from this scope and those around it."""
        for table in self._upwards():
            table.values.pop(name, None)

    def top(self) -> Table:
        """Return the outermost scope."""
        *_, outermost = self._upwards()
        return outermost

    def caller(self) -> Table | None:
        """Return the scope around this one, those of namespaces left out."""
        table = self.parent
        while table is not None and table.spaced and not self.spaced:
            table = table.parent
        return table

    def block(self, name: str) -> Block | None:
        """Return the block of a name."""
        return next((table.blocks[name] for table in self._upwards() if name in table.blocks), None)

    def macro(self, name: str) -> tuple[Macro, Table] | None:
        """Return a macro with the scope that its own is in; `name` may have namespaces in front."""
        macro = next((table.macros[name] for table in self._upwards() if name in table.macros), None)
        if macro is not None:
            return macro, self
        space, dot, rest = name.partition(".")
        inner = self[space] if dot and space in self else None
        return inner.macro(rest) if isinstance(inner, Table) else None


def literal(value: object) -> object:
    """Return the value of a text: a quoted text, a number or a boolean; any other value is itself."""
    if not isinstance(value, str) or HOLE in value:
        return value
    if len(value) > 1 and value[0] == value[-1] == "'":
        return value[1:-1]
    if value in _WORDS:
        return _WORDS[value]
    if "_" in value or len(value) > _MOST_DIGITS:
        return value
    for kind in (int, float):
        try:
            return kind(value)
        except ValueError:
            continue
    return value


def truth(value: object) -> bool:
    """Return the truth of a condition; `UnknownValueError` for an unknown one, `ValueError` if it is neither."""
    if isinstance(value, str):
        if HOLE in value:
            raise UnknownValueError
        return _WORDS[value] if value in _WORDS else bool(int(value))
    return bool(value)


_PARAMETER: Final = re.compile(
    r"""\s*(?P<name>[^\s:=]+)"""
    r"""(?P<given>\s*:?=\s*(?P<forward>\^\|?)?"""
    r"""(?P<default>\$\{[^}]*\}|\$\([^)]*\)|(?:'[^']*'|"[^"]*"|[^\s'"])*))?(?=\s|$)"""
)
_MOST_PARAMETERS: Final = 1000


def grab_macro(element: Element, file: FilePath) -> Macro:
    """Return the macro that an element defines."""
    parameters: dict[str, tuple[bool, str | None] | None] = {}
    for match in _PARAMETER.finditer(element.attributes.get("params", "")):
        if len(parameters) >= _MOST_PARAMETERS:
            break
        default = (match["forward"] is not None, match["default"] or None) if match["given"] else None
        parameters[match["name"]] = default
    return Macro(element.attributes.get("name", "").removeprefix("xacro:"), element, parameters, file)


def called(macro: Macro, around: Table, call: tuple[Element, Table], blocks: Sequence[Block], texts: Texts) -> Table:
    """Return the scope of a macro's body: what the `call` gives, an element and its scope, else the defaults."""
    element, caller = call
    scope = Table(texts.value, around)
    waiting = iter(blocks)
    for name, default in macro.parameters.items():
        if name.startswith("*"):
            block = next(waiting, None)
            if block is not None:
                scope.blocks[name.lstrip("*")] = _content(block) if name.startswith("**") else block
        elif name in element.attributes:
            scope.set(name, texts.value(element.attributes[name], caller))
        elif default is not None:
            scope.set(name, _default(name, default, around, texts))
        else:
            scope.set(name, HOLE)
    return scope


def _default(name: str, default: tuple[bool, str | None], caller: Table, texts: Texts) -> object:
    forward, written = default
    if forward and name in caller:
        try:
            return caller[name]
        except UnknownValueError:
            return HOLE
    return HOLE if written is None and forward else texts.value(written or "", caller)


def _content(block: Block) -> Block:
    """Return the content of the one element of a block."""
    inner = (child for element in block.elements if not isinstance(element, str) for child in element.children)
    return Block(tuple(inner), block.scope, block.file)
