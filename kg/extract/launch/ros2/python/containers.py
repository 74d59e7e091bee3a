"""Lists, tuples and dictionaries: iteration, items, slices, and what comprehensions make."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.extract.launch.ros2.actions import Condition, Substitution
from kg.extract.launch.ros2.python.machine import MAX_ITEMS, Frame, Machine, written
from kg.extract.launch.ros2.python.operators import same, truth
from kg.extract.launch.ros2.python.texts import known, reason_of, words
from kg.extract.launch.ros2.python.values import (
    Choice,
    ContextValue,
    Guarded,
    Items,
    Library,
    Method,
    Module,
    Scope,
    Table,
    Unknown,
    Words,
    guard,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.extract.launch.ros2.python.values import Value
    from kg.facts import Location

__all__ = ["Containers", "hashable"]

_NOWHERE: Final = FilePath("", "")


def hashable(value: Value) -> bool:
    """Tell whether a value can be a key here."""
    if isinstance(value, tuple):
        return all(hashable(item) for item in value)
    return value is None or isinstance(value, str | bool | int | float | Words)


class Containers(Machine):
    """The part of the interpreter that knows containers."""

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
        if isinstance(receiver, Library):
            return self._library_item(receiver, key, words_of)
        if isinstance(receiver, Method) and isinstance(receiver.receiver, ContextValue):
            return self.configuration(receiver.receiver, known(key, self.context))
        if isinstance(receiver, Table):
            if hashable(key) and key in receiver:
                return receiver[key]
            if receiver.factory is not None and hashable(key):
                made = self.invoke(receiver.factory, [], {}, ast.Constant(None), Frame(Module(_NOWHERE, ""), Scope()))
                self.put(receiver, key, made, None)
                return made
            return receiver.rest or Unknown(f"`{words_of}` has no such entry")
        if isinstance(receiver, Items | tuple | str) and isinstance(key, int) and -len(receiver) <= key < len(receiver):
            found = receiver[key]
            return Unknown(f"it depends on `{found.condition.written}`") if isinstance(found, Guarded) else found
        if isinstance(receiver, Choice):
            return Choice(tuple((condition, self.item(each, key, words_of)) for condition, each in receiver.options))
        return Unknown(f"`{words_of}`: {reason_of(receiver)}" if not isinstance(receiver, Unknown) else receiver.reason)

    def _library_item(self, receiver: Library, key: Value, words_of: str) -> Value:
        name = known(key, self.context)
        if receiver.path == "os.environ" and name is not None:
            return Words((Substitution("env", ((name,),)),))
        return Unknown(f"`{words_of}` is known only when it runs")

    def configuration(self, receiver: ContextValue, name: str | None) -> Value:
        """Return `context.launch_configurations[name]`."""
        if receiver.context is None or name is None:
            return Unknown("a launch configuration is read where none is known")
        value = receiver.context.configuration(name)
        if value is None:
            return Unknown(f"the launch configuration `{name}` is not set")
        return words(value, f"the launch configuration `{name}` is not known")

    def cut(self, receiver: Value, bounds: Sequence[Value]) -> Value:
        """Return `receiver[a:b:c]`."""
        numbers = [bound for bound in bounds if bound is None or isinstance(bound, int)]
        if len(numbers) < len(bounds) or bounds[2] == 0:
            return Unknown("the bounds of a slice are not known")
        which = slice(numbers[0], numbers[1], numbers[2])
        if isinstance(receiver, Items):
            return Items(receiver[which], receiver.guards)
        return receiver[which] if isinstance(receiver, tuple | str) else Unknown(reason_of(receiver))

    def put(self, table: Table, key: Value, value: Value, place: Location | None) -> None:
        """Set an entry; under a condition that did not hold when the table was made it becomes a choice."""
        if not hashable(key):
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

    def generate(self, clauses: Sequence[ast.comprehension], frame: Frame, each: Callable[[], None]) -> str | None:
        """Run the clauses of a comprehension; return why not all of its items are known, None where they are."""
        inner = Frame(frame.module, Scope(parent=frame.scope))
        outer = frame.scope
        frame.scope = inner.scope
        try:
            return self._clause(list(clauses), frame, each)
        finally:
            frame.scope = outer

    def _clause(self, clauses: list[ast.comprehension], frame: Frame, each: Callable[[], None]) -> str | None:
        if not clauses:
            each()
            return None
        clause, *rest = clauses
        iterated = self.evaluate(clause.iter, frame)
        items = self.iterate(iterated)
        unsure = reason_of(iterated) if items is None else None
        if items is None:  # one item stands for all, under a condition
            words_of = f"for {written(clause.target)} in {written(clause.iter)}"
            items = [Guarded(Condition(None, written=words_of), Unknown(reason_of(iterated)))]
        for item in items:
            self.step()
            height = len(self.guards)
            if isinstance(item, Guarded):
                self.guards.append(item.condition)
            self.assign(clause.target, item.value if isinstance(item, Guarded) else item, frame)
            if self._holds(clause.ifs, frame):
                unsure = self._clause(rest, frame, each) or unsure
            del self.guards[height:]
        return unsure

    def _holds(self, tests: Sequence[ast.expr], frame: Frame) -> bool:
        """Tell whether tests may hold; one that is not known becomes a condition."""
        for test in tests:
            found = truth(self.evaluate(test, frame), self.context)
            if found is False:
                return False
            if found is None:
                self.guards.append(Condition(None, written=written(test)))
        return True
