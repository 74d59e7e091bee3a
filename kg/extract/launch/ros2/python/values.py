"""What an expression of a launch file can be besides the plain values of Python.

`None`, truth values, numbers, texts, tuples and sets stand for themselves; lists are `Items` and dictionaries `Table`,
which remember where they were made; actions are those of `kg.extract.launch.ros2.actions`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.extract.launch.ros2.actions import Condition

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterable

    from kg.corpus.files import FilePath
    from kg.extract.launch.ros2.actions import Action, Text
    from kg.extract.launch.ros2.context import Context
    from kg.facts import Location

__all__ = [
    "IGNORED",
    "Choice",
    "ContextValue",
    "Description",
    "Function",
    "Guarded",
    "Ignored",
    "Instance",
    "Items",
    "Klass",
    "Library",
    "LoadedFile",
    "Method",
    "Module",
    "PathValue",
    "Scope",
    "Source",
    "Table",
    "Unknown",
    "Value",
    "Words",
    "guard",
    "pair_of",
]

Value: TypeAlias = object
"""Any value of the language that is read."""


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
class Function:
    """A function or lambda of the build; `receiver` is bound as its first argument."""

    node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
    module: Module
    scope: Scope
    name: str
    defaults: dict[str, Value] = field(default_factory=dict)
    receiver: Value = None
    bound: bool = False


@dataclass(slots=True, eq=False)
class Klass:
    """A class of the build with the bases that it has."""

    name: str
    scope: Scope
    bases: tuple[Value, ...] = ()
    dataclass_fields: tuple[str, ...] = ()

    def find(self, name: str, depth: int = 8) -> tuple[bool, Value]:
        """Return whether the class or a base of the build has an attribute, and its value."""
        if name in self.scope.names:
            return True, self.scope.names[name]
        for base in self.bases if depth else ():
            if isinstance(base, Klass) and (found := base.find(name, depth - 1))[0]:
                return found
        return False, None


@dataclass(slots=True, eq=False)
class Instance:
    """An object of a class of the build."""

    klass: Klass
    attributes: dict[str, Value] = field(default_factory=dict)


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


@dataclass(frozen=True, slots=True)
class PathValue:
    """A `pathlib.Path`."""

    text: str | Words


@dataclass(frozen=True, slots=True, eq=False)
class LoadedFile:
    """An open file; `text` None where it cannot be read, for the `reason`."""

    text: str | None
    file: FilePath | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ContextValue:
    """The `LaunchContext` of an `OpaqueFunction`; None where the launch file makes one itself."""

    context: Context | None


@dataclass(slots=True, eq=False)
class Description:
    """A `LaunchDescription`."""

    entities: Items


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """A `LaunchDescriptionSource`: the path of a launch file, or a description made in place."""

    path: Text | None
    reason: str | None = None
    actions: tuple[Action, ...] | None = None


class Ignored:
    """An action or event that starts nothing and sets nothing."""


IGNORED: Final = Ignored()
