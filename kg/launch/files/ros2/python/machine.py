"""The interpreter for launch files: unknown conditions, and the bounds of its work.

Both branches run; a value that they make different is an `Either` whose alternatives carry the words of the condition.
Lists to which only one branch adds keep their items, and what was added is there under the condition.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from enum import Enum
from functools import partial
from itertools import count
from typing import TYPE_CHECKING, Final, TypeVar

from kg.facts import LaunchProblemKind
from kg.launch.files.ros2.python.values import (
    MARK,
    Fork,
    Instance,
    Later,
    guarded,
    is_substitution,
    reason_of,
    terms_of_way,
    text_of,
    words,
)
from kg.symbolic import form
from kg.symbolic.binding import unpack
from kg.symbolic.machine import Machine
from kg.symbolic.operators import NULL, plain, truth
from kg.symbolic.state import UNSET, Alias, Frame, Slot, Written
from kg.symbolic.values import (
    Either,
    Guard,
    Kind,
    Mapping,
    Object,
    Pack,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    Way,
    paths,
    rows,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kg.corpus.files import FilePath
    from kg.launch.files.ros2.actions import Substitution
    from kg.launch.files.ros2.python.language import LaunchPython
    from kg.symbolic.form import Expression, Function

EXIT: Final = Object(Kind(("sys", "exit")))
"""What a call gives that ends the program."""
_MOST_STEPS: Final = 60_000
"""A hundred times what the largest launch file of Nav2 takes."""
_MOST_OPTIONS: Final = 64
_MOST_ITEMS: Final = 5_000
_MOST_TEXT: Final = 200_000
_COMPARISONS: Final = frozenset({"==", "!=", "<", ">", "<=", ">=", "in"})


_MISSING: Final = frozenset({"the map has no such key", "the list has no such element"})
_Result = TypeVar("_Result")


class Halt(Exception):  # noqa: N818 - the end of the work, no error of anybody
    """The bound of the work is reached."""


class LaunchMachine(Machine):
    """The interpretation of one launch file."""

    language: LaunchPython

    def more(self) -> None:
        """Allow as many steps as one reading may take."""
        self.most_steps = self.steps + _MOST_STEPS

    def start(self) -> None:
        """Begin the work."""
        self.most_turns, self.most_repeats = 2_000, 24
        self.counts_endless, self.notes_conditions = True, False
        self.more()
        self._forks = count()
        self._heights: list[int] = [0]
        self.places: dict[int, tuple[Value, FilePath, tuple[int, ...]]] = {}
        """Where the items of lists and the keys of dictionaries stand, by identity."""

    def step(self, steps: int = 1) -> None:
        """Count steps of the work.

        Raises:
            Halt: if there were too many.
        """
        self.steps += steps
        if self.steps > self.most_steps:
            raise Halt

    def reached(self, limit: str) -> None:
        """Stop when the bound of steps is reached."""
        if limit == "steps":
            raise Halt

    def cut(self, loop: form.Loop, frame: Frame) -> None:
        """Note that a loop has more turns than are run."""
        reading = self.language.reading
        message = f"a loop is read for {self.most_turns:,} rounds only"
        reading.note(LaunchProblemKind.LIMIT, message, reading.at(frame.unit.key, loop.line))

    # Conditions

    def truth(self, value: Value) -> Truth | Guard | Unknown:
        """Return whether a value is true, as far as that is certain."""
        if isinstance(value, Either):
            truths = {self.truth(item) for item in value.items}
            return truths.pop() if len(truths) == 1 else Unknown("it depends")
        value = self.language.resolved(value)
        if isinstance(value, Text) and value.exact is None:
            return Truth(True) if any(isinstance(part, str) and part for part in value.parts) else Unknown("it depends")
        if isinstance(value, Sequence) and value.items:
            certain = any(not guarded(item)[1] and not isinstance(item, Unknown) for item in value.items)
            return Truth(True) if certain else Unknown("it depends")
        return truth(value)

    def holds(self, condition: Expression, frame: Frame) -> Truth | Guard | Unknown:
        """Return whether a condition holds; one that is not known is a term with its words."""
        truth = self.truth(self.value(condition, frame))
        return truth if isinstance(truth, Truth) else Guard((f"{MARK}{words(condition, frame.unit)}",))

    def tried(self, body: Callable[[], _Result]) -> _Result:
        """Return the result of a function, and undo its writes."""
        guards, self.guards = self.guards, []
        stack, heights = self.stack, self._heights
        self.stack, self._heights = [], [0]
        try:
            return self._journal.attempt(body)[1]
        finally:
            self.guards, self.stack, self._heights = guards, stack, heights

    def under(self, item: Value, terms: tuple[str, ...]) -> Value:
        """Return an item that is there only under conditions."""
        return Either((item,), (frozenset({(self.fork([terms]), 0)}),)) if terms else item

    def fork(self, terms: Iterable[tuple[str, ...]]) -> Fork:
        """Return a new choice between sides with these terms."""
        return Fork(next(self._forks), tuple(terms))

    def meet(self, values: list[Value], terms: list[tuple[str, ...]]) -> Value:
        """Return the value that alternatives have together."""
        return self._joined(values, self.fork(terms))

    def merge(self, sides: list[Written], terms: list[tuple[str, ...]]) -> None:
        """Write the values of several sides, of which one runs."""
        self._journal.merge(sides, self.fork(terms))

    def over(self, values: Iterable[Value], apply: Callable[..., Value]) -> Value:
        """Apply a function to each row of alternatives of some values; each result keeps its conditions."""
        values = tuple(values)
        if not any(isinstance(value, Either) for value in values):
            return apply(*values)
        results = ((apply(*row), way) for row, way in rows(values, _MOST_OPTIONS))
        return _either([(item, own | way) for result, way in results for item, own in paths(result)])

    def _joined(self, values: list[Value], choice: object) -> Value:
        given = [(value, index) for index, value in enumerate(values) if value != UNSET]
        if not given:
            return UNSET
        first = given[0][0]
        if len(given) == len(values) and all(_same(first, value) for value, _ in given):
            return first
        if len(given) > 1 and all(isinstance(value, Sequence) for value, _ in given):
            merged = _with_added([(value, index) for value, index in given if isinstance(value, Sequence)], choice)
            if merged is not None:
                return merged
        if len(given) > 1 and all(isinstance(value, Mapping) for value, _ in given):
            return self._merged([value for value, _ in given if isinstance(value, Mapping)], choice)
        return _either([(item, way | {(choice, index)}) for value, index in given for item, way in paths(value)])

    def _merged(self, values: list[Mapping], choice: object) -> Value:
        """Return dictionaries as one, whose entries are alternatives."""
        tables = [{_key(key): (key, value) for key, value in one.items} for one in values]
        entries = {name: entry[0] for table in tables for name, entry in table.items()}
        items = (
            (key, self._joined([table[name][1] if name in table else UNSET for table in tables], choice))
            for name, key in entries.items()
        )
        return Mapping(tuple(items), any(one.open for one in values), default=values[0].default)

    # Functions

    @contextmanager
    def entered(self, function: Function, this: Value | None = None) -> Iterator[None]:
        """Count a function as running, and remember the conditions that its call has."""
        self._heights.append(len(self.guards))
        try:
            with super().entered(function, this):
                yield
        finally:
            self._heights.pop()

    def leave(self, value: Value, frame: Frame) -> None:
        """Add a value that a function returns, under the conditions that it came to since it was called."""
        way: Way = frozenset({(self.fork([tuple(self.guards[self._heights[-1] :])]), 0)})
        frame.returned.append(Either((value,), (way,)))

    def result(self, frame: Frame, ended: str | None) -> Value:
        """Return the value of a call; None if it ends without one."""
        if ended is None or not frame.returned:
            self.leave(NULL, frame)
        returned = [pair for one in frame.returned for pair in paths(one)]
        terms = [terms_of_way(way) for _, way in returned]
        if not any(terms):
            return _either([pair for value, _ in returned for pair in paths(value)])
        fork = self.fork(terms)  # one for all, so that what two `return`s give is never combined
        return _either(
            [(item, own | {(fork, side)}) for side, (value, _) in enumerate(returned) for item, own in paths(value)]
        )

    # Statements

    def _step(self, statement: form.Step, frame: Frame) -> str | None:
        """Run an expression; the end of the program fails."""
        return "raise" if self.value(statement.value, frame) is EXIT else None

    def _block(self, block: form.Block, frame: Frame) -> str | None:
        """Run statements in a row; those after one that may have left run under the opposite of its condition."""
        return self._following(block.body, frame)

    def _following(self, body: tuple[form.Statement, ...], frame: Frame) -> str | None:
        height = len(self.guards)
        for index, statement in enumerate(body):
            ended = self.run(statement, frame)
            if ended is not None:
                return ended
            terms = tuple(self.guards[height:])
            if terms:
                written, ended = self._journal.attempt(partial(self._following, body[index + 1 :], frame))
                # Where the function has left, nobody reads its variables again: their new values need no condition.
                for key, (holder, name, value) in list(written.items()):
                    if holder is frame.variables and not isinstance(value, Sequence | Mapping | Enum):
                        self.write(holder, name, value)
                        del written[key]
                self.merge([written, {}], [terms, ()])
                return ended
        return None

    def _try(self, statement: form.Try, frame: Frame) -> str | None:
        """Run a block, and the first handler if it certainly fails."""
        ended = self.run(statement.body, frame)
        if ended == "raise" and statement.handlers:
            ended = self.run(statement.handlers[0], frame)
        elif ended is None and statement.otherwise is not None:
            ended = self.run(statement.otherwise, frame)
        last = self.run(statement.last, frame) if statement.last is not None else None
        return last if last is not None else ended

    def _each(self, loop: form.Loop, collection: Expression, frame: Frame) -> str | None:
        value = self.value(collection, frame)
        unsure = (f"{MARK}for {words(loop, frame.unit)} in {words(collection, frame.unit)}",)
        items = self.items(value)
        turns = items if items is not None else [(Unknown(reason_of(value)), unsure)]
        height = len(self.guards)
        for index, (item, terms) in enumerate(turns[: self.most_turns]):
            returned = len(frame.returned)
            slot: Slot = item
            shared = len(loop.targets) == 1 and isinstance(item, Mapping | Sequence) and isinstance(value, Sequence)
            if shared and isinstance(collection, form.Name | form.Member):
                at = form.Index(loop.line, collection, form.Literal(loop.line, float(index), str(index)))
                slot = Alias(at, frame, object=True)
            if terms:
                with self._under(terms):
                    written, ended = self._journal.attempt(partial(self._round, loop, slot, frame))
                self.merge([written, {}], [terms, ()])
                ended = ended if ended == "raise" else None
            else:
                ended = self._round(loop, slot, frame)
            if len(frame.returned) == returned:
                del self.guards[height:]
            if ended in ("return", "raise"):
                return ended
            if ended == "break":
                return None
        if len(turns) > self.most_turns:
            self.cut(loop, frame)
        return None

    def _round(self, loop: form.Loop, item: Slot, frame: Frame) -> str | None:
        self._target(loop, item, frame)
        return self._turn(loop, frame)

    def _target(self, loop: form.Loop, item: Slot, frame: Frame) -> None:
        if len(loop.targets) == 1 or isinstance(item, Alias | Pack):
            self.write(frame.variables, loop.targets[0], item)
            return
        targets = tuple(form.Name(loop.line, (name,)) for name in loop.targets)
        for name in loop.targets:
            frame.variables.setdefault(name, UNSET)
        unpack(self, targets, item, frame)

    def items(self, value: Value) -> list[tuple[Value, tuple[str, ...]]] | None:
        """Return the items of an iterable, each with its conditions; None if they are unknown."""
        if isinstance(value, Either):
            pairs: list[tuple[Value, tuple[str, ...]]] = []
            for option, way in paths(value):
                inner = self.items(option)
                if inner is None:
                    return None
                pairs += [(item, (*terms_of_way(way), *terms)) for item, terms in inner]
            return pairs
        closed = isinstance(value, Mapping) and not value.open
        if isinstance(value, Sequence) or closed or (isinstance(value, Text) and value.exact is not None):
            rest: list[Value] = [Unknown("there may be more")] if isinstance(value, Sequence) and value.open else []
            items = value.items if isinstance(value, Sequence) else self.language.elements(value)
            return [guarded(item) for item in (*items, *rest)]
        return None

    # Expressions

    def _name(self, expression: form.Name, frame: Frame) -> Value:
        holder = frame.holder(expression.names[0])
        value = holder[expression.names[0]] if holder is not None else self.language.name(expression, frame)
        if isinstance(value, Alias):
            return self.value(value.target, value.frame)
        return value if not isinstance(value, Pack) else Sequence(value.items)

    def _member(self, expression: form.Member, frame: Frame) -> Value:
        of = self.value(expression.of, frame)
        return self.over((of,), lambda one: self.language.member(one, expression.name))

    def _display(self, expression: form.Display, frame: Frame) -> Value:
        values = self.arguments(expression.items, frame)
        if len(values) == len(expression.items):
            pairs = zip(values, expression.items, strict=True)
            values = [self.placed(value, frame.unit.key, getattr(item, "line", 1)) for value, item in pairs]
        sequence = Sequence(tuple(values))
        self.step(len(sequence.items) // 20)
        lines = tuple(item.line for item in expression.items if not isinstance(item, form.Type))
        self.place(sequence, frame.unit.key, *(lines if len(lines) == len(sequence.items) else ()), expression.line)
        return sequence

    def _pairs(self, expression: form.Pairs, frame: Frame) -> Value:
        pairs: dict[object, tuple[Value, Value]] = {}
        is_open = False
        for written, of in expression.items:
            key, value = self.value(written, frame), self.value(of, frame)
            if isinstance(key, Unknown | Either):
                is_open = True
                continue
            self.place(key, frame.unit.key, getattr(written, "line", expression.line))
            pairs[_key(key)] = key, value
        return Mapping(tuple(pairs.values()), is_open)

    def placed(self, value: Value, file: FilePath, line: int) -> Value:
        """Return a value that is not known as one that is at a line, unless it already does."""
        if not isinstance(value, Unknown) or value == NULL or id(value) in self.places:
            return value
        copy = replace(value)
        self.place(copy, file, line)
        return copy

    def place(self, value: Value, file: FilePath, *lines: int) -> None:
        """Record the place of a value: of its items, if each has a line, and then of itself."""
        self.places[id(value)] = value, file, lines

    def flattened(self, value: Value) -> Value:
        """Return one of several lists as a list of items that are there under conditions."""
        if not isinstance(value, Either) or not all(isinstance(one, Sequence) for one in value.items):
            return value
        return Sequence(tuple(self.under(item, terms) for item, terms in self.items(value) or ()))

    def _assignment(self, expression: form.Assign, frame: Frame) -> Value:
        if expression.sign != "+":
            return super()._assignment(expression, frame)
        values = map(self.flattened, (self.value(expression.target, frame), self.value(expression.value, frame)))
        value = self.over(values, lambda *row: self.computed("+", row))
        self.assign(expression.target, value, frame)
        return value

    def _binary(self, expression: form.Binary, frame: Frame) -> Value:
        if expression.sign == "+":
            values = [self.flattened(self.value(operand, frame)) for operand in expression.operands]
            return self.over(values, lambda *row: self.computed("+", row))
        if expression.sign not in ("and", "or"):
            return super()._binary(expression, frame)
        value: Value = NULL
        unsure: Value | None = None
        for operand in expression.operands:
            value = self.value(operand, frame)
            last = expression.sign == "and" or operand is expression.operands[-1]
            if not last and _is_unset(self.language.resolved(value)):
                continue
            truth = self.truth(value)
            if not isinstance(truth, Truth):
                unsure = Unknown(f"it depends on `{words(operand, frame.unit)}`")
            elif truth.value is (expression.sign == "or"):
                return value if unsure is None or isinstance(value, Truth) else unsure
        return value if unsure is None else unsure

    def computed(self, sign: str, row: tuple[Value, ...]) -> Value:
        """Return the result of an operator; texts and lists do not grow beyond a bound."""
        if sign in _COMPARISONS:
            row = tuple(map(self.language.resolved, row))
            objects = [is_substitution(value) for value in row]
            if sign in ("==", "!=") and any(objects) and not isinstance(row[objects.index(True) - 1], Unknown | Either):
                return Truth((row[0] is row[1]) == (sign == "=="))
            return super().computed(sign, row)
        if sign in ("/", "true/") and (is_substitution(row[0]) or isinstance(row[0], Text)):
            return self.language.below(row)
        if sign == "+" and any(map(is_substitution, row)):
            return self.language.joined(row)
        if sign == "+" and any(isinstance(value, Sequence) for value in row):
            return self._listed(row)
        self._check(row)
        result = super().computed(sign, row)
        unknown = next((value for value in row if plain(value) is None), None)
        return Unknown(reason_of(unknown)) if isinstance(result, Unknown) and unknown is not None else result

    def _index(self, expression: form.Index, frame: Frame) -> Value:
        of, key = self.value(expression.of, frame), self.value(expression.key, frame)
        entry = self.over((of, key), self.language.element)
        missing = isinstance(entry, Unknown) and entry.reason in _MISSING
        return Unknown(f"`{words(expression, frame.unit)}` has no such entry") if missing else entry

    def _listed(self, row: tuple[Value, ...]) -> Value:
        """Return lists in a row, of which not all need to be known."""
        self._check(row)
        items = [one for value in row for one in (value.items if isinstance(value, Sequence) else (value,))]
        sequence = Sequence(tuple(items))
        places = [self.places.get(id(value)) for value in row]
        if all(place is not None for place in places) and len({place[1] for place in places if place}) == 1:
            lines = [line for place in places if place for line in place[2][:-1]]
            if len(lines) == len(items):
                self.place(sequence, next(place[1] for place in places if place), *lines, lines[0] if lines else 1)
        return sequence

    def _check(self, row: tuple[Value, ...]) -> None:
        items = sum(len(value.items) for value in row if isinstance(value, Sequence))
        letters = sum(
            len(part) for value in row if isinstance(value, Text) for part in value.parts if isinstance(part, str)
        )
        if items > _MOST_ITEMS or letters > _MOST_TEXT:
            raise Halt
        self.step((items + letters) // 20)

    def assign(self, target: Expression, value: Value, frame: Frame) -> None:
        """Set a variable, a member or an element; keys of dictionaries remember where they were set."""
        if isinstance(target, form.Index):
            of, key = self.value(target.of, frame), self.value(target.key, frame)
            if isinstance(of, Instance):
                self.language.configure(of, key, value)
                return
            self.place(key, frame.unit.key, target.line)
            changed = self.over((of,), lambda one: self.language.with_element(one, key, value))
            self.assign(target.of, changed, frame)
            return
        super().assign(target, value, frame)


def _is_unset(value: Value) -> bool:
    """Return whether a value is a variable of the environment that has no default, and that nobody gives a value."""
    variable = value.parts[0] if isinstance(value, Text) and len(value.parts) == 1 else None
    return isinstance(variable, Later) and variable.part.kind == "env" and len(variable.part.arguments) == 1


def resolve_text(value: Value, perform: Callable[[Substitution], str | None]) -> Value:
    """Return a text with the parts that are known by now."""
    if not isinstance(value, Text) or value.exact is not None:
        return value
    texts = [perform(part.part) if isinstance(part, Later) else None for part in value.parts]
    pieces = [part if text is None else text for part, text in zip(value.parts, texts, strict=True)]
    if all(text is None for text in texts):
        return value
    if all(isinstance(piece, str) for piece in pieces):
        return Text.of("".join(map(str, pieces)))
    return text_of([piece.part if isinstance(piece, Later) else str(piece) for piece in pieces])


def _either(pairs: list[tuple[Value, Way]]) -> Value:
    """Return alternatives, each with the choices that lead to it."""
    distinct: list[tuple[Value, Way]] = []
    for item, way in pairs:
        if not any(own is item and other == way for own, other in distinct):
            distinct.append((item, way))
    if not distinct:
        return Unknown("its parts exclude each other")
    first, way = distinct[0]
    if (len(distinct) == 1 and not way) or (len(distinct) > 1 and all(_same(first, item) for item, _ in distinct)):
        return first
    if len(distinct) > _MOST_OPTIONS:
        return Unknown(f"it has more than {_MOST_OPTIONS} possible values")
    return Either(tuple(item for item, _ in distinct), tuple(way for _, way in distinct))


def _same(one: Value, other: Value) -> bool:
    return one is other or (type(one) is type(other) and one == other)


def _key(key: Value) -> object:
    return key.exact if isinstance(key, Text) and key.exact is not None else key


def _with_added(values: list[tuple[Sequence, int]], choice: object) -> Value | None:
    """Return lists that begin alike as one, in which what each has besides is there under its conditions.

    None for other lists: one of them is meant, unless they are lists of actions.
    """
    columns = enumerate(zip(*(value.items for value, _ in values), strict=False))
    shortest = min(len(value.items) for value, _ in values)
    end = next((index for index, row in columns if not all(_same(row[0], one) for one in row)), shortest)
    rests = [(item, index) for value, index in values for item in value.items[end:]]
    objects = all(isinstance(one, Object) for item, _ in rests for one, _ in paths(item))
    if end < shortest and (end == 0 or not objects):
        return None
    items: list[Value] = list(values[0][0].items[:end])
    for item, index in rests:
        pairs = [(one, way | {(choice, index)}) for one, way in paths(item)]
        items.append(Either(tuple(one for one, _ in pairs), tuple(way for _, way in pairs)))
    return Sequence(tuple(items), any(value.open for value, _ in values))
