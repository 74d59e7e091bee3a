"""One Python file, indexed: scopes, what they bind, what they call, what they import.

A `Scope` is a module, class body or function. Bindings remember under which branches of `if` and
`except` they stand, so that values chosen in one branch are never mixed with those of another.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Final

from kg.extract.python.syntax import argument_nodes, code

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.corpus.workspace import FilePath

__all__ = ["MODULE", "Arms", "Binding", "CallSite", "Import", "Parameters", "Scope", "Unit"]

MODULE: Final = "<module>"

Arms = tuple[tuple[int, int], ...]
"""Branches around a place, outermost first: pairs of the start of the `if` (or `except`) and the branch's number."""


@dataclass(frozen=True, slots=True)
class Binding:
    """A name given a value: by assignment, `for`, `with`, `+=` or an item assigned.

    `path` says which part of an unpacked value the name takes; `start` is where the binding begins to hold,
    `within` the end of the comprehension that it is confined to. `loop` is the start of the `for` it comes from.
    """

    name: str
    kind: str
    value: Node | None
    path: tuple[int, ...]
    start: int
    arms: Arms
    scope: Scope
    loop: int = -1
    within: tuple[int, int] | None = None
    key: Node | None = None


@dataclass(frozen=True, slots=True)
class CallSite:
    """A call: the last word of what is called, and where."""

    name: str
    node: Node
    arms: Arms


@dataclass(frozen=True, slots=True)
class Import:
    """An imported name: the module (leading dots kept) and the attribute taken from it, if one is."""

    module: str
    attribute: str | None


@dataclass(slots=True)
class Parameters:
    """The parameters of a function in order, with defaults; `rest` and `keywords` name `*args` and `**kwargs`."""

    positional: list[str] = field(default_factory=list)
    defaults: dict[str, Node] = field(default_factory=dict)
    annotations: dict[str, Node] = field(default_factory=dict)
    rest: str | None = None
    keywords: str | None = None


@dataclass(slots=True, eq=False)
class Scope:
    """A module, class body or function; `owner` is the class whose method it is."""

    name: str
    node: Node
    unit: Unit
    kind: str
    start: int
    end: int
    parent: Scope | None = None
    arms: Arms = ()
    bindings: dict[str, list[Binding]] = field(default_factory=dict)
    calls: list[CallSite] = field(default_factory=list)
    returns: list[tuple[Node, Arms]] = field(default_factory=list)
    globals: set[str] = field(default_factory=set)
    functions: dict[str, Scope] = field(default_factory=dict)
    classes: dict[str, Scope] = field(default_factory=dict)
    holes: list[tuple[int, int]] = field(default_factory=list)
    decorators: tuple[str, ...] = ()
    _parameters: Parameters | None = None
    _words: frozenset[str] | None = None

    @property
    def owner(self) -> Scope | None:
        """The class that this function is a method of."""
        return self.parent if self.parent is not None and self.parent.kind == "class" else None

    @property
    def parameters(self) -> Parameters:
        """The parameters; read when first asked for."""
        if self._parameters is None:
            self._parameters = _read_parameters(self.node)
        return self._parameters

    @property
    def receiver(self) -> str | None:
        """The name of the parameter that is the object of a method (`self`)."""
        names = self.parameters.positional if self.owner and "staticmethod" not in self.decorators else []
        return names[0] if names else None

    @property
    def words(self) -> frozenset[str]:
        """All words of its own text, without scopes inside and imports: a filter (comments count), never a proof."""
        if self._words is None:
            self._words = frozenset(self.text.translate(_WORD_BYTES).decode("utf-8", "replace").split())
        return self._words

    @property
    def text(self) -> bytes:
        """The bytes of the scope without those of the scopes inside of it and of imports."""
        pieces, start = [], self.start
        for hole_start, hole_end in self.holes:
            pieces.append(self.unit.source[start:hole_start])
            start = max(start, hole_end)
        return b" ".join((*pieces, self.unit.source[start : self.end]))

    @property
    def line(self) -> int:
        """The line that the scope begins at."""
        return self.node.start_point.row + 1

    def bases(self) -> list[Node]:
        """Return the expressions that a class names as its bases."""
        return [base for base in argument_nodes(self.node) if base.type != "keyword_argument"]


@dataclass(eq=False)
class Unit:
    """A file with its index; `ifs` maps the start of each `if` to its node."""

    file: FilePath
    source: bytes
    module: Scope = field(init=False)
    scopes: list[Scope] = field(default_factory=list)
    imports: dict[str, Import] = field(default_factory=dict)
    stars: list[str] = field(default_factory=list)
    ifs: dict[int, Node] = field(default_factory=dict)
    arm_counts: dict[int, tuple[int, bool]] = field(default_factory=dict)
    """For each `if`, how many branches it has and whether the last is an `else`."""
    too_deep: int | None = None
    """The line of the first function or class that is nested too deep to be a scope of its own."""

    @cached_property
    def classes(self) -> list[Scope]:
        """All classes of the file."""
        return [scope for scope in self.scopes if scope.kind == "class"]


_WORD_BYTES: Final = bytes(
    byte if chr(byte).isalnum() or byte == ord("_") or not chr(byte).isascii() else 0x20 for byte in range(256)
)

_SKIPPED: Final = frozenset({"keyword_separator", "positional_separator", "comment"})


def _read_parameters(node: Node) -> Parameters:
    found = Parameters()
    listed = node.child_by_field_name("parameters")
    for child in listed.named_children if listed is not None else ():
        if child.type not in _SKIPPED:
            _read_parameter(child, found)
    return found


def _read_parameter(node: Node, found: Parameters) -> None:
    inner = node.named_children[0] if node.type == "typed_parameter" else node
    if inner.type == "list_splat_pattern":
        found.rest = code(inner.named_children[0]) if inner.named_child_count else None
        return
    if inner.type == "dictionary_splat_pattern":
        found.keywords = code(inner.named_children[0])
        return
    name = code(inner.child_by_field_name("name") or inner)
    found.positional.append(name)
    default = node.child_by_field_name("value")
    if default is not None:
        found.defaults[name] = default
    annotation = node.child_by_field_name("type")
    if annotation is not None:
        found.annotations[name] = annotation
