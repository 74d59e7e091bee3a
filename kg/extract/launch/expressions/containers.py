"""Lists, tuples and dictionaries: how they are made, changed, iterated over and indexed, within the bounds of the work.

What is added to a container under a condition that did not hold when it was made is there under that condition only.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.expressions.operators import same
from kg.extract.launch.expressions.texts import reason_of
from kg.extract.launch.expressions.values import Choice, Guarded, Items, Table, Unknown, Words, guard
from kg.extract.launch.expressions.whole import MAX_ITEMS, ExpressionError, apply, is_whole

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterable, Sequence

    from kg.extract.launch.expressions.texts import Settler
    from kg.extract.launch.expressions.values import Condition, Frame, Value
    from kg.facts import Location

__all__ = ["Containers", "Halt", "hashable"]

_MAX_STEPS: Final = 60_000
"""A hundred times what the largest launch file of Nav2 takes."""
_ITEMS_OF_A_STEP: Final = 20


class Halt(Exception):  # noqa: N818 - the end of the work, no error of anybody
    """The bound of the work is reached."""


def hashable(value: Value) -> bool:
    """Tell whether a value can be a key here."""
    if isinstance(value, tuple):
        return all(hashable(item) for item in value)
    return value is None or isinstance(value, str | bool | int | float | Words)


def _sliced(receiver: Any, *bounds: Any) -> object:
    return receiver[slice(*bounds)]


class Containers(ABC):
    """The state of one evaluation; `context` performs substitutions that are evaluated now, `guards` hold now."""

    def __init__(self) -> None:
        self.context: Settler | None = None
        self.guards: list[Condition] = []
        self.steps = 0
        self.kept: dict[int, tuple[Items | Table, list[Value] | Table]] = {}

    @abstractmethod
    def location(self, node: ast.AST, frame: Frame) -> Location:
        """Return where a node stands."""

    @abstractmethod
    def unresolved(self, reason: str, location: Location, subject: str | None = None) -> Unknown:
        """Note once that something cannot be known."""

    @abstractmethod
    def made(self, table: Table) -> Value:
        """Return an entry that a `defaultdict` makes."""

    def step(self) -> None:
        """Count a step of the work.

        Raises:
            Halt: when there were too many.
        """
        self.steps += 1
        if self.steps > _MAX_STEPS:
            raise Halt

    def weigh(self, value: Value) -> Value:
        """Return a value that was made at once, having counted the steps that its length is worth.

        Raises:
            Halt: when there were too many.
        """
        if isinstance(value, Items | tuple | str):
            self.steps += len(value) // _ITEMS_OF_A_STEP
            self.step()
        return value

    def items(self, values: Iterable[Value] = ()) -> Items:
        """Return a list that is made now."""
        made = Items(values, tuple(self.guards))
        self.weigh(made)
        return made

    def distinct(self, values: Sequence[Value]) -> Items:
        """Return a set that is made now, as a list in the order of the values."""
        if not all(is_whole(value) for value in values):
            return self.items(values)
        if not all(hashable(value) for value in values):
            raise ExpressionError("TypeError: a set contains a list or a dictionary")
        return self.items(dict.fromkeys(values))

    def table(self) -> Table:
        """Return a dictionary that is made now."""
        return Table(tuple(self.guards))

    def guarded(self, value: Value, guards: tuple[Condition, ...]) -> Value:
        """Return a value as an item of a list made under `guards`: with the conditions that hold now besides."""
        for condition in reversed(self.guards):
            if not any(condition is other for other in guards):
                value = guard(condition, value)
        return value

    def keep(self, container: Items | Table) -> None:
        """Remember a container before it changes, since the body of an `OpaqueFunction` may be read again."""
        if self.context is not None and id(container) not in self.kept:
            copied = list(container) if isinstance(container, Items) else container.copy()
            self.kept[id(container)] = container, copied

    def restore(self) -> None:
        """Give the containers back what was in them before they were changed."""
        for container, before in self.kept.values():
            if isinstance(container, Items) and isinstance(before, list):
                container[:] = before
            elif isinstance(container, Table) and isinstance(before, Table):
                container.clear()
                container.update(before)
        self.kept.clear()

    def append(self, items: Items, values: Iterable[Value]) -> None:
        """Add values to the end of a list.

        Raises:
            Halt: when the list is too long.
        """
        self.keep(items)
        items.extend(self.guarded(value, items.guards) for value in values)
        if len(items) > MAX_ITEMS:
            raise Halt

    def iterate(self, value: Value) -> list[Value] | None:
        """Return the items of what is iterated over; None where they are not known."""
        if isinstance(value, Items | tuple):
            return list(value)
        if isinstance(value, Table):
            return None if value.rest else list(value)
        if isinstance(value, str):
            return list(value) if len(value) <= MAX_ITEMS else None
        if isinstance(value, Choice):
            found: list[Value] = []
            for condition, option in value.options:
                inner = self.iterate(option)
                if inner is None:
                    return None
                found += [guard(condition, item) if condition else item for item in inner]
            return found
        return None

    def item(self, receiver: Value, key: Value, words_of: str) -> Value:
        """Return `receiver[key]`."""
        if isinstance(receiver, Table):
            return self._entry(receiver, key, words_of)
        if isinstance(receiver, Items | tuple | str) and isinstance(key, int):
            if not -len(receiver) <= key < len(receiver):
                raise ExpressionError(f"IndexError: `{words_of}` is out of range")
            found = receiver[key]
            return Unknown(f"it depends on `{found.condition.written}`") if isinstance(found, Guarded) else found
        if isinstance(receiver, Choice):
            return Choice(tuple((condition, self.item(each, key, words_of)) for condition, each in receiver.options))
        if is_whole(receiver) and is_whole(key):
            raise ExpressionError(f"TypeError: `{words_of}` is no item")
        unknown = key if isinstance(receiver, Items | tuple | str) else receiver
        return unknown if isinstance(unknown, Unknown) else Unknown(f"`{words_of}`: {reason_of(unknown)}")

    def _entry(self, table: Table, key: Value, words_of: str) -> Value:
        if hashable(key) and key in table:
            return table[key]
        if table.factory is not None and hashable(key):
            found = self.made(table)
            self.put(table, key, found, None)
            return found
        if table.rest is None and is_whole(key):
            raise ExpressionError(f"KeyError: `{words_of}` has no such entry")
        return table.rest or Unknown(f"`{words_of}` has no such entry")

    def cut(self, receiver: Value, bounds: Sequence[Value]) -> Value:
        """Return `receiver[a:b:c]`."""
        if isinstance(receiver, Items | tuple | str) and all(is_whole(bound) for bound in bounds):
            found = apply(_sliced, [receiver, *bounds])
            return Items(found, receiver.guards) if isinstance(receiver, Items) and isinstance(found, Items) else found
        if is_whole(receiver) and not isinstance(receiver, Items | tuple | str):
            raise ExpressionError(f"TypeError: '{type(receiver).__name__}' object has no slices")
        return Unknown("the bounds of a slice are not known") if is_whole(receiver) else Unknown(reason_of(receiver))

    def put(self, table: Table, key: Value, value: Value, place: Location | None) -> None:
        """Set an entry; under a condition that did not hold when the table was made it becomes a choice."""
        if not hashable(key):
            if isinstance(key, Items | Table):
                raise ExpressionError(f"TypeError: a {type(key).__name__.lower()} cannot be a key")
            table.rest = Unknown(reason_of(key))
            return
        self.keep(table)
        guarded = self.guarded(value, table.guards)
        if isinstance(guarded, Guarded) and not same(table.get(key), value):
            other = ((None, table[key]),) if key in table else ()
            table.put(key, Choice(((guarded.condition, value), *other)), place)
            return
        table.put(key, value, place)

    def spread_table(self, table: Table, value: Value) -> None:
        """Set all entries of another dictionary."""
        if not isinstance(value, Table):
            table.rest = Unknown(reason_of(value))
            return
        for key, item in value.items():
            self.put(table, key, item, value.places.get(key))
        table.rest = table.rest or value.rest
