"""Values of expressions in launch files.

`None`, truth values, numbers, texts and tuples of Python stand for themselves. Lists are `Items` and dictionaries
`Table`, which record where and under which conditions they were made. A text with unknown parts is `Words`. Any other
object is of the language that is evaluated.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterable

    from kg.corpus.files import FilePath
    from kg.facts import Location

__all__ = [
    "Choice",
    "Condition",
    "Frame",
    "Function",
    "Guarded",
    "Items",
    "Library",
    "Method",
    "Module",
    "Object",
    "Part",
    "Scope",
    "Substitution",
    "Table",
    "Text",
    "TextLike",
    "Unknown",
    "Value",
    "Words",
    "guard",
    "pair_of",
]

Value: TypeAlias = object
"""Any value of the language that is read."""


@dataclass(frozen=True, slots=True)
class Substitution:
    """A part of a text that is known only when it is executed.

    `kind` is that of the XML form: `var`, `env`, `find-pkg-share`, `find-pkg-prefix`, `find-exec`, `dirname`,
    `filename`, `eval`, `command`, `anon`, `not`, `and`, `or`, `any`, `all`, `equals`, `not-equals`, `if`,
    `file-content`, `path-join`, `local`, `unknown` (then `reason` tells why). `arguments` are its operands in order; a
    missing default is left out. Two have no form in XML: `replaced-file` gives the name of a copy of a file (operands:
    the file, whether texts are replaced, and old and new texts in turn), `rewritten-file` that of a copy of `file`, a
    `ParameterFile`.
    """

    kind: str
    arguments: tuple[Text, ...] = ()
    reason: str | None = None
    file: object = None


Part: TypeAlias = str | Substitution
Text: TypeAlias = tuple[Part, ...]


class Object:
    """An object that Python takes for true."""

    __slots__ = ()


class TextLike(Object, ABC):
    """A value that can stand for a text, such as a path."""

    __slots__ = ()

    @abstractmethod
    def as_text(self) -> Value:
        """Return the text."""

    def below(self, other: Value) -> Value:
        """Return `self / other`."""
        return Unknown(f"what is below a {type(self).__name__.lower()}: {type(other).__name__.lower()}")


@dataclass(frozen=True, slots=True)
class Condition(Object):
    """`value` has to be true (`IfCondition`), or not with `negated` (`UnlessCondition`); None: it cannot be known."""

    value: Text | None
    negated: bool = False
    written: str = ""

    @property
    def words(self) -> str:
        """What has to hold, in the words of the file."""
        text = self.written or "what is known only when it runs"
        return f"not {text}" if self.negated else text


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that cannot be known without running the file, why, and where it is used."""

    reason: str
    place: Location | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Words:
    """A text with parts that are known only later; a substitution of launch where `lazy`, else what one gave."""

    parts: Text
    lazy: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """One of several values, each with a condition that cannot be known; None where there is none."""

    options: tuple[tuple[Condition | None, Value], ...]

    @property
    def reason(self) -> str:
        """Why it is not known which."""
        words = next((condition.written for condition, _ in self.options if condition), "")
        return f"it depends on `{words}`"


@dataclass(frozen=True, slots=True, eq=False)
class Guarded:
    """An item of a list that is there only under a condition that cannot be known."""

    condition: Condition
    value: Value


def guard(condition: Condition, value: Value) -> Guarded:
    """Return a value that is there under a condition besides those that it already has."""
    if not isinstance(value, Guarded):
        return Guarded(condition, value)
    both = Condition(None, written=f"{condition.words} and {value.condition.words}")
    return Guarded(both, value.value)


def pair_of(value: Value) -> tuple[Value, Value] | None:
    """Return the two items of a list or tuple of two; None for all else."""
    if not isinstance(value, Items | tuple):
        return None
    match list(value):
        case [first, second]:
            return first, second
    return None


class Items(list[Value]):
    """A list; `guards` are the conditions under which it was made, `places` where its items stand, if that is known."""

    def __init__(
        self, items: Iterable[Value] = (), guards: tuple[Condition, ...] = (), places: tuple[Location, ...] = ()
    ) -> None:
        super().__init__(items)
        self.guards = guards
        self.places = places if len(places) == len(self) else ()


class Table(dict[Value, Value]):
    """A dictionary with the place of each entry; `rest` tells why it may have more entries than are known.

    `factory` makes the entries of a `defaultdict`.
    """

    def __init__(self, guards: tuple[Condition, ...] = ()) -> None:
        super().__init__()
        self.places: dict[Value, Location] = {}
        self.guards = guards
        self.rest: Unknown | None = None
        self.factory: Value = None

    def put(self, key: Value, value: Value, place: Location | None) -> None:
        """Set an entry that stands at a place."""
        self[key] = value
        if place is not None:
            self.places[key] = place

    def copy(self) -> Table:
        """Return another table of the same entries."""
        other = Table(self.guards)
        other.update(self)
        other.places.update(self.places)
        other.rest, other.factory = self.rest, self.factory
        return other


@dataclass(slots=True, eq=False)
class Scope:
    """The names of a module, class body or one call of a function."""

    names: dict[str, Value] = field(default_factory=dict)
    parent: Scope | None = None
    outer: set[str] = field(default_factory=set)
    """Names declared `global` or `nonlocal`."""

    def find(self, name: str) -> Scope | None:
        """Return the nearest scope that binds a name."""
        scope: Scope | None = self
        while scope is not None and name not in scope.names:
            scope = scope.parent
        return scope

    def bind(self, name: str, value: Value) -> None:
        """Bind a name here, or where a declaration says."""
        scope = (self.parent and self.parent.find(name)) if name in self.outer else None
        (scope or self).names[name] = value


@dataclass(slots=True, eq=False)
class Module:
    """A module of the build."""

    file: FilePath
    name: str
    scope: Scope = field(default_factory=Scope)


@dataclass(slots=True, eq=False)
class Frame:
    """One run of a module, class body or function; `pending` are values that it may already have returned."""

    module: Module
    scope: Scope
    pending: list[tuple[Condition | None, Value]] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Function(Object):
    """A function or lambda of the build; `receiver` is bound as its first argument."""

    node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
    module: Module
    scope: Scope
    name: str
    defaults: dict[str, Value] = field(default_factory=dict)
    receiver: Value = None
    bound: bool = False


@dataclass(frozen=True, slots=True)
class Library:
    """Something of a module that is not in the build, by its full name."""

    path: str

    @property
    def name(self) -> str:
        """The last part of its name."""
        return self.path.rpartition(".")[2]


@dataclass(frozen=True, slots=True, eq=False)
class Method:
    """A method of a value that is no object of the build."""

    receiver: Value
    name: str
