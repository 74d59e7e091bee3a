"""The state of an interpretation: frames with their variables, and a journal of writes that can be reverted."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from typing import TYPE_CHECKING, Final, TypeAlias, TypeVar, cast, final

from kg.symbolic.form import Call, Expression, Opaque, Type, Unit
from kg.symbolic.operators import NULL, under
from kg.symbolic.values import (
    ABSENT,
    UNASSIGNED,
    Either,
    Enumerator,
    Kind,
    Mapping,
    Number,
    Pack,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from collections.abc import Mapping as Names

    from kg.symbolic.form import Function
    from kg.symbolic.language import Language


class _Missing(Enum):
    """The value of a variable before its first write."""

    MISSING = auto()


_RECURSION: Final = 20_000
_MOST_INSTANCES: Final = 16
"""How many instances of a function template run within each other."""
_MISSING: Final = _Missing.MISSING
UNSET: Final = Unknown("it has no value")
_EMPTY: Final = Text.of("")
_Result = TypeVar("_Result")


def decides(value: object) -> bool:
    """Check whether a value decides conditions and is not part of a name: a number, null, something empty."""
    if isinstance(value, (Sequence, Mapping)):
        return not value.items
    return isinstance(value, (Truth, Number, Enumerator)) or value in (NULL, UNSET, _EMPTY, UNASSIGNED)


@final
@dataclass(slots=True, eq=False)
class Alias:
    """A reference to the value of an expression in another frame."""

    target: Expression
    frame: Frame
    object: bool = False
    """Whether it means the object only: an assignment to the name leaves the other variable as it is."""


_SPECIAL: Final = (Alias, Pack)
"""What is not joined with other values."""
Slot: TypeAlias = Value | Alias
Variables: TypeAlias = dict[str, Slot]


def are_alike(one: Variables, other: Variables) -> bool:
    """Check whether two states of the variables of a frame say the same, whatever decides between alternatives."""
    return one.keys() == other.keys() and all(_is_alike(value, other[name]) for name, value in one.items())


def _is_alike(one: Slot, other: Slot) -> bool:
    if isinstance(one, Either) and isinstance(other, Either):
        return len(one.items) == len(other.items) and all(map(_is_alike, one.items, other.items))
    return one is other or one == other or (isinstance(one, Unknown) and isinstance(other, Unknown))


@dataclass(unsafe_hash=True, slots=True)
class Site:
    """A call on the way to a fact: its file and line, and the object that runs it."""

    unit: Unit
    line: int
    this: Value | None = None
    given: tuple[Expression, ...] = ()
    """Its arguments, as expressions."""
    frame: Frame | None = field(default=None, compare=False)
    """The function that it is in."""


@dataclass(slots=True, eq=False)
class Frame:
    """A running function: its variables, and the values of its template parameters."""

    unit: Unit
    scope: tuple[str, ...]
    this: Value | None = None
    variables: Variables = field(default_factory=dict)
    types: dict[str, Value] = field(default_factory=dict)
    parent: Frame | None = None
    returned: list[Value] = field(default_factory=list)
    declared: dict[str, Type] = field(default_factory=dict)
    """The types of its variables, as written."""
    returns: Type | None = None
    """The type of its result, as written."""

    def outward(self) -> Iterator[Frame]:
        """Yield this frame and those around it, from the inside out."""
        frame: Frame | None = self
        while frame is not None:
            yield frame
            frame = frame.parent

    def holder(self, name: str) -> Variables | None:
        """Return the variables of the innermost frame that has a variable of a name."""
        frame: Frame | None = self
        while frame is not None:
            if name in frame.variables:
                return frame.variables
            frame = frame.parent
        return None

    def bound_type(self, name: str) -> Value | None:
        """Return the value of a template parameter."""
        frame: Frame | None = self
        while frame is not None:
            if name in frame.types:
                return frame.types[name]
            frame = frame.parent
        return None

    def repeats(self, function: Function, usual: int) -> int:
        """Return how often a function may run within itself: more often if numbers are arguments of its template."""
        counts = any(isinstance(self.types.get(name), Number) for name in function.template)
        return max(usual, _MOST_INSTANCES) if counts else usual

    @property
    def templated(self) -> bool:
        """Whether it has values of template parameters."""
        frame: Frame | None = self
        while frame is not None:
            if frame.types:
                return True
            frame = frame.parent
        return False


@dataclass(slots=True)
class Arguments:
    """The arguments of a call: their values, those of its template, and the call as written in the caller's frame."""

    values: list[Value]
    template: tuple[Value, ...] = ()
    call: Call | None = None
    frame: Frame | None = None
    named: Names[str, Value] = field(default_factory=dict)
    """The values of arguments by name."""
    expressions: tuple[Expression, ...] | None = None
    """The arguments as expressions, where they are in another order than in the call."""

    @property
    def written(self) -> tuple[Expression, ...]:
        """The arguments as expressions."""
        if self.expressions is not None:
            return self.expressions
        return self.call.arguments if self.call is not None else ()

    @property
    def line(self) -> int:
        """The line of the call, 0 if there is none."""
        return self.call.line if self.call is not None else 0

    def placed(self, parameters: tuple[str, ...]) -> Arguments:
        """Return the arguments with those by name at the places of parameters."""
        if not parameters or not self.named:
            return self
        given = dict(self.call.keywords) if self.call is not None else {}
        values, written, others = list(self.values), list(self.written), dict(self.named)
        for index, name in enumerate(parameters):
            if name not in self.named or index < len(self.values):
                continue
            while len(values) <= index:
                values.append(ABSENT)
            values[index] = others.pop(name)
            written += [Opaque(0, "")] * (index + 1 - len(written))
            written[index] = given.get(name, written[index])
        return replace(self, values=values, named=others, expressions=tuple(written))


@dataclass(slots=True)
class Invocation:
    """A call of a framework: the node or handle that it is made on, its arguments, and the type of its receiver."""

    node: Value | None
    arguments: Arguments
    kind: Kind | None = None

    def argument(self, index: int | None) -> Value | None:
        """Return the value of an argument; None if the call has no such argument."""
        values = self.arguments.values
        value = values[index] if index is not None and index < len(values) else None
        return None if value is ABSENT else value

    def declared(self, index: int | None, language: Language) -> Kind | None:
        """Return the declared type of the variable that is passed as an argument."""
        frame, written = self.arguments.frame, self.arguments.written
        if index is None or frame is None or index >= len(written):
            return None
        return language.type_of(written[index], frame)


Holder: TypeAlias = dict[str, Value] | Variables
_Entry: TypeAlias = tuple[Variables, str, Slot | _Missing]
Written: TypeAlias = dict[tuple[int, str], _Entry]
"""The last write to each variable or field: its holder, its name, and its value or `_MISSING`."""


@contextmanager
def deep_recursion() -> Iterator[None]:
    """Allow the nesting of calls that an interpretation has, until the end of a `with` statement."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, _RECURSION))
    try:
        yield
    finally:
        sys.setrecursionlimit(limit)


class Journal:
    """Writes to variables and fields, recorded while one side of a branch runs.

    `joined` returns the value that several alternatives have together.
    """

    def __init__(self, joined: Callable[[list[Value], object], Value]) -> None:
        self._joined = joined
        self._entries: list[_Entry] | None = None
        self._created: set[int] = set()
        """The variables and fields, by identity, of what the side that runs created: no other side has them."""

    @property
    def open(self) -> bool:
        """Whether one side of a branch runs."""
        return self._entries is not None

    def created(self, *holders: Holder) -> None:
        """Record that an object with these fields was created."""
        if self._entries is not None:
            self._created.update(map(id, holders))

    def write(self, holder: Holder, name: str, value: Slot) -> None:
        """Set a variable or a field."""
        slots = cast("Variables", holder)  # dict is invariant, but fields receive values only
        if self._entries is not None and id(slots) not in self._created:  # what a side created is as it left it
            self._entries.append((slots, name, slots.get(name, _MISSING)))
        slots[name] = value

    def ahead(self, run: Callable[[], _Result]) -> _Result:
        """Run a function as if it had run before the branch: what it writes stays on every side."""
        outer, self._entries = self._entries, None
        try:
            return run()
        finally:
            self._entries = outer

    def attempt(self, run: Callable[[], _Result]) -> tuple[Written, _Result]:
        """Run a function and revert its writes; return them with the function's result."""
        outer, self._entries = self._entries, []
        created, self._created = self._created, set()
        try:
            result = run()
        finally:
            entries, self._entries = self._entries, outer
            self._created = created | self._created if outer is not None else created
        written: Written = {}
        for holder, name, _ in entries:
            written[id(holder), name] = (holder, name, holder.get(name, _MISSING))
        for holder, name, before in reversed(entries):  # the value before the first write is restored last
            if before is _MISSING:
                holder.pop(name, None)
            else:
                holder[name] = before
        return written, result

    def merge(self, sides: list[Written], choice: object, terms: list[tuple[str, ...]] | None = None) -> None:
        """Write the joined values of several sides, one of which runs; `choice` stands for which.

        `terms` are the guards of each side, which say more about the values that it has.
        """
        keys: Written = {}
        for side in sides:
            keys |= side
        for key, (holder, name, _) in keys.items():
            before = holder.get(name, _MISSING)
            values = [side[key][2] if key in side else before for side in sides]
            slots: list[Slot] = [UNSET if isinstance(value, _Missing) else value for value in values]
            if terms is not None:
                pairs = zip(slots, terms, strict=True)
                slots = [under(value, term) if isinstance(value, Text) else value for value, term in pairs]
            plain: list[Value] = [value for value in slots if not isinstance(value, _SPECIAL)]
            self.write(holder, name, slots[0] if len(plain) != len(slots) else self._joined(plain, choice))
