"""The interpreter: runs the intermediate form forward from what starts a node, over abstract values and objects.

If the condition of a branch is known, one side runs. Otherwise every side runs on the state before the branch, and the
journal joins their writes. Loops over known collections run once for each element; others run once, and their counters
become unknown. Limits on steps, depth and turns end an interpretation; `bounds` contains the limits that were reached.
"""

from __future__ import annotations

from collections import Counter, deque
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from kg.symbolic import binding, form
from kg.symbolic.binding import assign_member, bind, bind_targets, forget_awaited, hand_back, put, unpack, write_back
from kg.symbolic.containers import counted_by, grown, is_finite
from kg.symbolic.narrowing import Arm, attempt, conditions_at, exclude, narrowed
from kg.symbolic.operators import (
    chosen,
    compute,
    literal,
    logical,
    negate,
    negative,
    opposite_terms,
    terms_of,
    truth,
)
from kg.symbolic.spelling import member_label
from kg.symbolic.state import UNSET, Alias, Frame, Holder, Journal, Site, Slot, Variables, Written, are_alike
from kg.symbolic.values import (
    Bound,
    Closure,
    Guard,
    Kind,
    Mapping,
    Number,
    Object,
    Pack,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    alternatives,
    join,
    number,
    options,
    over,
    read_back,
    whole_parameter,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kg.symbolic.effects import Framework
    from kg.symbolic.form import Expression, Function, Statement
    from kg.symbolic.language import Language

DEEPEST: Final = 70
MOST_FRUITLESS: Final = 6  # runs of a function that never declares anything, and returns and writes `_PLAIN` values
MOST_BRIEF: Final = 4  # steps of a function that runs at each call whatever it returns, such as a getter
MOST_BARREN: Final = 3_000  # steps of a function in all its runs that declare nothing; then it does not run again
MOST_IDLE: Final = 5_000  # steps of a loop in turns that declare nothing; after that it ends
_MOST_SITES: Final = 12  # calls on the way to its registration that a callback keeps
_PLAIN: Final = (Unknown, Number, Truth)  # values that are seldom part of a name
_OUT: Final = ("return", "raise", "exit")
_LEFT: Final = (*_OUT, "break")
_COUNTS: Final = Unknown("it counts the turns of a loop", label="")


class Machine:
    """One interpretation. `language` resolves names, `framework` evaluates calls of frameworks."""

    most_steps = 250_000
    most_turns = 64
    most_repeats = 2
    counts_endless = False  # whether loops whose condition always holds run turn by turn
    notes_conditions = True  # whether guards have conditions that no parameter decides; not in callbacks

    def __init__(self, language: Language, framework: Framework) -> None:
        self.language = language
        self.framework = framework
        self.stack: list[Site] = []
        self.running: Counter[int] = Counter()
        self.queue: deque[Callable[[], object]] = deque()
        self.queued: set[object] = set()
        self.guards: list[str] = []
        self.bounds: dict[str, Site] = {}
        """The limits that were reached, each with the call that was running then."""
        self.fruitless: Counter[int] = Counter()
        self.barren: Counter[int] = Counter()
        self.fruitful: set[int] = set()
        """The functions that declared something in a run, by identity. With other arguments they may do so again."""
        self.executed: set[tuple[int, int]] = set()  # functions that have run, and the object of each, by identity
        self.steps = 0
        self.counting = False  # whether the condition of a loop is evaluated: only that counts the default of a list
        self.globals: dict[object, Variables] = {}
        self._journal = Journal(self._joined)
        self._local: Variables = {}  # those of the function that runs
        self._outer_writes = 0  # writes to other variables and to fields of a value that can be part of a name
        self._counted = 0  # how many have a number
        self._left: list[tuple[str, Written, tuple[str, ...]]] = []
        """The writes of sides of branches that left the turn or function that runs: how, what, and on what terms."""
        self._statements: dict[type, Callable[[Any, Frame], str | None]] = {
            form.Block: self._block,
            form.Case: self._case,
            form.Step: self._step,
            form.Declare: self._declare,
            form.Branch: self._branch,
            form.Loop: self._loop,
            form.Try: self._try,
            form.Return: self._return,
            form.Jump: lambda statement, _: statement.kind,
            **language.statements,
        }
        self._values: dict[type, Callable[[Any, Frame], Value]] = {
            form.Literal: lambda expression, _: literal(expression),
            form.Name: self._name,
            form.Member: self._member,
            form.Call: partial(self._called, language.call),
            form.Construct: partial(self._called, language.construct_expression),
            form.Unary: self._unary,
            form.Binary: self._binary,
            form.Choice: self._choice,
            form.Index: self._index,
            form.Display: self._display,
            form.Pairs: self._pairs,
            form.Lambda: lambda expression, frame: Closure(expression.function, frame),
            form.Assign: self._assignment,
            form.Opaque: self._opaque,
            form.Type: self._type,
            **language.expressions,
        }

    def write(self, holder: Holder, name: str, value: Slot) -> None:
        """Set a variable or a field."""
        if holder is not self._local and holder.get(name) is not value:
            self._outer_writes += not isinstance(value, _PLAIN)
            self._counted += isinstance(value, Number)
        self._journal.write(holder, name, value)

    def ahead(self, run: Callable[[], object]) -> bool:
        """Run code as if it had run before all branches; return whether that makes no difference to its effects."""
        before = self.framework.progress()
        self._journal.ahead(run)
        return not self._journal.open or self.framework.progress() == before

    def created(self, instance: Object) -> Object:
        """Return a new object, after recording that only the side of a branch that runs has it."""
        self._journal.created(instance.fields, instance.native)
        return instance

    def _joined(self, values: list[Value], choice: object) -> Value:
        joined = options(values, choice)
        for value in values if not (isinstance(joined, Text) and joined.exact == "" and joined.parameter) else ():
            parameter = getattr(value, "parameter", None)
            if parameter is not None and whole_parameter(value) and not whole_parameter(joined):
                self.framework.defaulted(parameter, joined)
        return joined

    # What conditions make of values

    def holds(self, condition: Expression, frame: Frame) -> Truth | Guard | Unknown:
        """Return whether a condition holds, with the terms that its branch runs under."""
        return truth(self.value(condition, frame))

    def over(self, values: Iterable[Value], apply: Callable[..., Value]) -> Value:
        """Apply a function to each row of alternatives of some values, and join the results."""
        return over(values, apply)

    def meet(self, values: list[Value], terms: list[tuple[str, ...]]) -> Value:  # noqa: ARG002 - for other machines
        """Return the value that alternatives have together; `terms` are the conditions of each."""
        return join(*values)

    def merge(self, sides: list[Written], terms: list[tuple[str, ...]]) -> None:
        """Write the values of several sides, of which one runs; `terms` are the conditions of each."""
        self._journal.merge(sides, object(), terms)

    def leave(self, value: Value, frame: Frame) -> None:
        """Add a value that a function returns."""
        frame.returned.append(value)

    def result(self, frame: Frame, ended: str | None) -> Value:  # noqa: ARG002 - the same
        """Return the value of a call, from all that its function returned."""
        return join(*frame.returned) if frame.returned else Unknown("it returns nothing")

    def is_decided(self, ends: list[str | None]) -> bool:
        """Check whether what follows a branch runs under the conditions of the one side that did not leave.

        A side that raises checks values: what fails creates nothing, so that is no condition worth recording.
        """
        return any(end not in (None, "raise") for end in ends)

    # Running

    def drain(self) -> None:
        """Run the scheduled callbacks, and those that they schedule."""
        while self.queue:
            self.queue.popleft()()

    def schedule(self, key: object, work: Callable[[], object], *, notes_conditions: bool = False) -> None:
        """Run a callback later, as part of the calls and conditions that lead to it now, once for each key."""
        if key in self.queued:
            return
        stack, guards = self.stack[:_MOST_SITES], list(self.guards)

        def run() -> None:
            outer = self.stack, self.guards, self.notes_conditions
            self.stack, self.guards, self.notes_conditions = list(stack), list(guards), notes_conditions
            try:
                work()
            finally:
                self.stack, self.guards, self.notes_conditions = outer

        self.queued.add(key)
        self.queue.append(run)

    def _block(self, block: form.Block, frame: Frame) -> str | None:
        """Run statements in a row; what they declare hides variables of the same name until the end of the block."""
        declared = () if block.open else [one.name for one in block.body if isinstance(one, form.Declare)]
        hidden = {name: frame.variables[name] for name in declared if name in frame.variables}
        ended = None
        for inner in block.body:
            ended = self.run(inner, frame)
            if ended is not None:
                break
        for name, value in hidden.items():
            self.write(frame.variables, name, value)
        return ended

    def reached(self, limit: str) -> None:
        """Record a limit and where it was reached first."""
        if self.stack:
            self.bounds.setdefault(limit, self.stack[-1])

    def run(self, statement: Statement, frame: Frame) -> str | None:
        """Run a statement; return None, or how it left the ones after it: `return`, `break`, `continue` or `raise`."""
        self.steps += 1
        if self.steps > self.most_steps:
            self.reached("steps")
            return "return"
        return self._statements[type(statement)](statement, frame)

    def _step(self, statement: form.Step, frame: Frame) -> str | None:
        self.value(statement.value, frame)
        return None

    def _return(self, statement: form.Return, frame: Frame) -> str:
        if statement.value is not None:
            value = self.value(statement.value, frame)
            local = isinstance(statement.value, form.Name) and statement.value.names[0] in frame.variables
            written = None if local else statement.value
            self.leave(self.language.converted(value, frame.returns, written, frame), frame)
        return "return"

    def _declare(self, statement: form.Declare, frame: Frame) -> None:
        kind, written = statement.type, statement.value
        if written is None:
            value = self.language.default(kind, frame, statement.line) if kind is not None else UNSET
        else:
            value = self.value(written, frame)
            if isinstance(written, form.Type):
                frame.types[statement.name] = value
                return
            if kind is None or not kind.reference or not isinstance(written, (form.Name, form.Member, form.Index)):
                value = self.language.converted(value, kind, written, frame)
            elif not isinstance(value, (Object, Unknown)):
                self.write(frame.variables, statement.name, Alias(written, frame))
                return
        if kind is not None:
            frame.declared[statement.name] = kind
        self.write(frame.variables, statement.name, value)

    @contextmanager
    def _under(self, terms: Iterable[str]) -> Iterator[None]:
        before = len(self.guards)
        self.guards += [term for term in terms if term not in self.guards]
        try:
            yield
        finally:
            del self.guards[before:]

    def _branch(self, statement: form.Branch, frame: Frame) -> str | None:
        arms, sides = list[Arm](), list[Written]()
        ends, terms = list[str | None](), list[tuple[str, ...]]()
        negated: list[str] = []
        closed = False
        unknown = later = tuple[str, ...]()
        for condition, body in statement.arms:
            holds = Truth(True) if condition is None else self.holds(condition, frame)
            if isinstance(holds, Truth):
                if not holds.value:
                    continue
                closed = True
                if not sides:  # a program that always ends here would be useless: what decides is not really known
                    ended = self.run(body, frame)
                    return ended if ended != "exit" else None
            terms.append((*negated, *terms_of(holds)))
            arms.append((condition, body))
            if self.notes_conditions:
                unknown, later = conditions_at(statement, condition, holds, frame, later)
            with self._under((*terms[-1], *unknown)):
                narrow = narrowed(self, arms, frame)
                written, ended = attempt(self._journal, narrow, partial(self.run, body, frame))
            sides.append(written)
            ends.append(ended if ended != "exit" else "raise")
            if closed:
                break
            negated += opposite_terms(holds)
        if not closed:
            sides.append({})
            ends.append(None)
            terms.append(tuple(negated))
        live = self._joined_sides(sides, ends, terms)
        if not live:
            return next((end for end in ends if end != "raise"), "raise")
        exclude(self, self._journal, arms, ends, frame)
        if len(live) == 1 and self.is_decided(ends):
            self.guards += [term for term in terms[live[0]] if term not in self.guards]
        return None

    def _joined_sides(self, sides: list[Written], ends: list[str | None], terms: list[tuple[str, ...]]) -> list[int]:
        """Join the writes of the sides that reach the next statement, and return these sides.

        If there are any, the writes of the others wait for the end of the loop turn or of the function.
        """
        live = [index for index, end in enumerate(ends) if end is None]
        chosen = live or range(len(sides))
        self.merge([sides[index] for index in chosen], [terms[index] for index in chosen])
        if live:
            rows = zip(sides, ends, terms, strict=True)
            self._left += [(end, side, under) for side, end, under in rows if end and side]
        return live

    def _rejoin(self, left: list[tuple[str, Written, tuple[str, ...]]], ends: tuple[str, ...]) -> None:
        """Write what sides of branches wrote that left some code by one of `ends`, after this code."""
        here = [one for one in left if one[0] in ends]
        self._left += [one for one in left if one[0] != "raise" and one[0] not in ends]
        if here:
            self.merge([{}, *(side for _, side, _ in here)], [(), *(terms for _, _, terms in here)])

    def _part(self, run: Callable[[], str | None], *ends: str) -> str | None:
        """Run a turn of a loop or a case of a `switch`; sides of branches that leave it by `ends` go on after it."""
        outer, self._left = self._left, []
        ended = run()
        left, self._left = self._left, outer
        if left:
            self._rejoin(left, ends)
        return ended

    def _turn(self, loop: form.Loop, frame: Frame) -> str | None:
        return self._part(partial(self.run, loop.body, frame), "break", "continue")

    def _case(self, case: form.Case, frame: Frame) -> str | None:
        ended = self._part(partial(self._block, case, frame), "break")
        return None if ended == "break" else ended

    def _try(self, statement: form.Try, frame: Frame) -> str | None:
        """Run a block, then each of its handlers as one side of a branch."""
        ended = self.run(statement.body, frame)
        tried = [self._journal.attempt(partial(self.run, handler, frame)) for handler in statement.handlers]
        sides: list[Written] = [written for written, _ in tried]
        ends: list[str | None] = [end for _, end in tried]
        if ended != "raise" or not sides:
            if ended is None and statement.otherwise is not None:
                written, ended = self._journal.attempt(partial(self.run, statement.otherwise, frame))
                sides.append(written)
            else:
                sides.append({})
            ends.append(ended)
        live = self._joined_sides(sides, ends, [()] * len(sides))
        last = self.run(statement.last, frame) if statement.last is not None else None
        if last is not None or live:
            return last
        return next((end for end in ends if end != "raise"), "raise")

    def _loop(self, loop: form.Loop, frame: Frame) -> str | None:
        """Run a loop; the variables that it declares hide those of the same name until its end."""
        names = loop.targets if loop.declared is not None else ()
        if isinstance(loop.first, form.Block):
            names = tuple(one.name for one in loop.first.body if isinstance(one, form.Declare))
        hidden = {name: frame.variables[name] for name in names if name in frame.variables}
        ended = self._turns(loop, frame)
        if ended is None and loop.step is None and loop.condition is not None:
            forget_awaited(self, loop, loop.condition, frame)
        for name, value in hidden.items():
            self.write(frame.variables, name, value)
        return ended

    def _turns(self, loop: form.Loop, frame: Frame) -> str | None:
        if loop.over is not None:
            return self._each(loop, loop.over, frame)
        if loop.first is not None:
            self.run(loop.first, frame)
        condition = loop.condition
        if condition is None or (loop.runs_at_least_once and not self.counts_endless):
            return self._unknown_times(loop, frame, ())
        before, begun = self.framework.progress(), self.steps
        for _ in range(self.most_turns):
            previous = dict(frame.variables) if loop.step is None else {}
            writes = self._outer_writes + self._counted
            counting, self.counting = self.counting, True
            holds = self.holds(condition, frame)
            self.counting = counting
            if not isinstance(holds, Truth):
                return self._unknown_times(loop, frame, terms_of(holds))
            if not holds.value:
                return None
            ended = self._turn(loop, frame)
            if ended in _LEFT or self._is_idle(before, begun):
                return ended if ended in _OUT else None
            if loop.step is not None:
                self.value(loop.step, frame)
            elif writes == self._outer_writes + self._counted and are_alike(previous, frame.variables):
                return None  # the next turns are the same: the loop waits for other code
        if self.framework.progress() != before:  # else the turns that are left create nothing either
            self.cut(loop, frame)
        return None

    def _is_idle(self, before: tuple[int, ...], begun: int) -> bool:
        """Check whether a loop has taken many steps since `begun`, without an effect since the progress `before`."""
        return self.steps - begun > MOST_IDLE and self.framework.progress() == before

    def cut(self, loop: form.Loop, frame: Frame) -> None:  # noqa: ARG002 - for other machines
        """Record that a loop has more turns than are run."""
        self.reached("turns")

    def _unknown_times(self, loop: form.Loop, frame: Frame, terms: tuple[str, ...]) -> str | None:
        """Run a loop once, on unknown counters; one that tests first may also not run."""
        self._forget_counters(loop, frame)

        def once(counters: Iterable[tuple[Holder, str]] = ()) -> str | None:
            for holder, name in counters:
                self.write(holder, name, _COUNTS)
            ended = self._turn(loop, frame)
            if loop.step is not None and ended is None:
                self.value(loop.step, frame)
            return ended

        if loop.runs_at_least_once:
            ended = once()
            return ended if ended in _OUT else None
        before = self.framework.progress()
        with self._under(terms):
            written, _ = self._journal.attempt(once)
            if (counters := counted_by(written)) and self.framework.progress() != before:
                # Functions that the loop calls count its turns, too: what it creates depends on the turn.
                written, _ = self._journal.attempt(partial(once, counters))
        self.merge([grown(written), {}], [terms, ()])
        return None

    def _forget_counters(self, loop: form.Loop, frame: Frame) -> None:
        for target in self.language.counted(loop):
            self.assign(target, _COUNTS, frame)

    def _each(self, loop: form.Loop, collection: Expression, frame: Frame) -> str | None:
        choices = alternatives(self.value(collection, frame))
        if len(choices) == 1:
            return self._over(loop, choices[0], frame)
        sides = [self._journal.attempt(partial(self._over, loop, one, frame))[0] for one in choices]
        self.merge(sides, [()] * len(sides))
        return None

    def _over(self, loop: form.Loop, over: Value, frame: Frame) -> str | None:
        items = self.language.elements(over)
        finite = is_finite(over)
        if finite and len(items) > self.most_turns:
            self.cut(loop, frame)
            items = items[: self.most_turns]
        before, begun = self.framework.progress(), self.steps
        for index, item in enumerate(items):
            bind_targets(self, loop, item, frame)
            if finite:
                ended = self._turn(loop, frame)
                write_back(self, loop, index, frame)
                if ended in _LEFT or self._is_idle(before, begun):
                    return ended if ended in _OUT else None
            else:
                self._forget_counters(loop, frame)
                written, _ = self._journal.attempt(partial(self._turn, loop, frame))
                self.merge([grown(written), {}], [(), ()])
        return None

    # Expressions

    def value(self, expression: Expression, frame: Frame) -> Value:
        """Return the value of an expression, and perform its effects."""
        self.steps += 1
        if self.steps > self.most_steps:
            self.reached("steps")
            return Unknown("the interpretation was too long")
        return self._values[type(expression)](expression, frame)

    def _name(self, expression: form.Name, frame: Frame) -> Value:
        names = expression.names
        if len(names) == 1:  # as `Frame.holder`, in the place that runs most often
            name = names[0]
            around: Frame | None = frame
            while around is not None:
                slot = around.variables.get(name)
                if slot is not None:
                    return read_back(self.value(slot.target, slot.frame) if type(slot) is Alias else slot, name)
                around = around.parent
        return read_back(self.language.name(expression, frame), names[-1])

    def _member(self, expression: form.Member, frame: Frame) -> Value:
        of = self.value(expression.of, frame)
        members = self.over((of,), lambda one: self.language.member(one, expression.name))
        return read_back(members, member_label(expression))

    def _called(
        self, run: Callable[[Any, Frame], Value], expression: form.Call | form.Construct, frame: Frame
    ) -> Value:
        self.stack.append(Site(frame.unit, expression.line, frame.this, expression.arguments, frame))
        try:
            return run(expression, frame)
        finally:
            self.stack.pop()

    def arguments(self, expressions: Iterable[Expression], frame: Frame) -> list[Value]:
        """Return the values of arguments, those of a variadic parameter each for itself."""
        values: list[Value] = []
        for expression in expressions:
            value = self.value(expression, frame)
            if type(value) is Pack:
                values += value.items
            else:
                values.append(value)
        return values

    def _unary(self, expression: form.Unary, frame: Frame) -> Value:
        sign = expression.sign
        operand = self.value(expression.operand, frame)
        if sign in ("&", "*", "+"):
            return operand
        if sign in ("!", "not"):
            return self.over((operand,), lambda one: negate(truth(one)))
        if sign in ("++", "--"):
            change = 1 if sign == "++" else -1
            new = over((operand,), lambda one: number(one.value + change) if isinstance(one, Number) else _COUNTS)
            self.assign(expression.operand, new, frame)
            return operand
        return self.over((operand,), negative) if sign == "-" else Unknown("it is computed")

    def _binary(self, expression: form.Binary, frame: Frame) -> Value:
        sign = expression.sign
        if sign in ("&&", "||", "and", "or"):
            operands = (partial(self.value, operand, frame) for operand in expression.operands)
            return (logical if sign in ("&&", "||") else chosen)(operands, all_of=sign in ("&&", "and"))
        values = [self.value(operand, frame) for operand in expression.operands]
        if sign == ",":
            return values[-1] if values else Unknown("it is empty")
        if sign == "<<":
            special = self.language.shifted(values)
            if special is not None:
                return special
        if sign == ">>" and isinstance(values[0], Object):
            for operand in expression.operands[1:]:
                put(self, operand, Text.hole("it is read from a stream"), frame)
            return Unknown("it is read from a stream")
        return self.over(values, lambda *row: self.computed(sign, row))

    def computed(self, sign: str, row: tuple[Value, ...]) -> Value:
        """Return the result of an operator on values without alternatives."""
        if sign == "%" and isinstance(row[0], (Text, Object)):
            return self.language.formatted(row)
        return compute(sign, row)

    def _choice(self, expression: form.Choice, frame: Frame) -> Value:
        holds = self.holds(expression.condition, frame)
        if isinstance(holds, Truth):
            return self.value(expression.then if holds.value else expression.otherwise, frame)
        terms = terms_of(holds)
        opposite = opposite_terms(holds)
        with self._under(terms):
            one = self.value(expression.then, frame)
        with self._under(opposite):
            other = self.value(expression.otherwise, frame)
        return self.meet([one, other], [terms, opposite])

    def _index(self, expression: form.Index, frame: Frame) -> Value:
        of, key = self.value(expression.of, frame), self.value(expression.key, frame)
        return self.over((of, key), self.language.element)

    def _display(self, expression: form.Display, frame: Frame) -> Value:
        return Sequence(tuple(self.arguments(expression.items, frame)))

    def _pairs(self, expression: form.Pairs, frame: Frame) -> Value:
        return Mapping(tuple((self.value(key, frame), self.value(value, frame)) for key, value in expression.items))

    def _assignment(self, expression: form.Assign, frame: Frame) -> Value:
        target = expression.target
        value = self.value(expression.value, frame)
        if expression.sign == "designated" and isinstance(target, form.Name):
            return Sequence((Text.of(target.names[0]), value))
        if expression.sign:
            before = self.value(target, frame)
            value = self.over((before, value), lambda *row: self.computed(expression.sign, row))
        else:
            value = self.language.assigned(target, value, expression.value, frame)
        name = target.names[0] if isinstance(target, form.Name) and not expression.sign else ""
        slot = frame.variables.get(name)
        if isinstance(slot, Alias) and slot.object:
            self.write(frame.variables, name, value)
        else:
            self.assign(target, value, frame)
        return value

    def assign(self, target: Expression, value: Value, frame: Frame) -> None:
        """Set a variable, a member or an element."""
        if isinstance(target, form.Name):
            holder = frame.holder(target.names[0]) if len(target.names) == 1 else None
            slot = holder[target.names[0]] if holder is not None else None
            if holder is None:
                self.language.assign_name(target, value, frame)
            elif isinstance(slot, Alias):
                self.assign(slot.target, value, slot.frame)
            else:
                self.write(holder, target.names[0], value)
        elif isinstance(target, form.Member):
            assign_member(self, target, value, frame)
        elif isinstance(target, form.Index):
            containers = alternatives(self.value(target.of, frame))
            key = self.value(target.key, frame)
            self.assign(target.of, join(*(self.language.with_element(one, key, value) for one in containers)), frame)
        elif isinstance(target, form.Display):
            unpack(self, target.items, value, frame)
        elif isinstance(target, form.Unary) and target.sign == "*":
            self.assign(target.operand, value, frame)

    def _opaque(self, expression: form.Opaque, frame: Frame) -> Value:
        for part in expression.parts:
            self.value(part, frame)
        return Unknown(f"`{expression.text}` is not evaluated" if expression.text else "it is not evaluated")

    def _type(self, expression: form.Type, frame: Frame) -> Value:
        resolved = self.language.kind(expression, frame)
        return TypeValue(resolved) if isinstance(resolved, Kind) else resolved

    # Functions

    def invoke(
        self,
        function: Function,
        frame: Frame,
        arguments: list[Value],
        given: tuple[Expression, ...] = (),
        caller: Frame | None = None,
    ) -> Value:
        """Run a function in its new frame; its writes to reference parameters go to the caller's arguments `given`."""
        if len(self.stack) > DEEPEST:
            self.reached("depth")
            return Unknown("the calls are too deep")
        if self.running[id(function)] >= frame.repeats(function, self.most_repeats):
            return Unknown("it calls itself")
        fruitless = self.fruitless[id(function)]
        handed = any(isinstance(one, (Closure, Bound)) for one in arguments) if fruitless else True
        # Most code declares nothing. Run at each call, it would take most of the time of an extraction.
        settled = fruitless >= MOST_FRUITLESS or self.barren[id(function)] > MOST_BARREN
        settled = settled or not (handed or self.language.reaches(function))
        if settled or (caller and not self.notes_conditions and self.language.spares(function, frame.this, arguments)):
            if caller is not None:
                binding.leave_open(self, zip(function.parameters, given, arguments, strict=False), caller)
            return self.language.unknown(function.returns, frame, function.name)
        before, steps, writes = self.framework.progress(), self.steps, self._outer_writes
        outer, self._local = self._local, frame.variables
        with self.entered(function, frame.this):
            bind(self, function, frame, arguments, given)
            result = self.result(frame, self.run(function.body, frame))
        written = False
        if caller is not None and len(given) == len(arguments):
            written = hand_back(self, zip(function.parameters, given, arguments, strict=False), frame, caller)
        self._local = outer
        if self.framework.progress() != before:
            self.fruitful.add(id(function))
        elif not written:  # a text that it finds for its caller can be a name
            self.barren[id(function)] += (taken := self.steps - steps)
            idle = taken > MOST_BRIEF and isinstance(result, _PLAIN) and self._outer_writes == writes
            self.fruitless[id(function)] += idle and id(function) not in self.fruitful
        return result

    @contextmanager
    def entered(self, function: Function, this: Value | None = None) -> Iterator[None]:
        """Count a function as running; the guards of its body end with it."""
        guards = len(self.guards)
        self.running[id(function)] += 1
        self.executed.add((id(function), id(this)))
        outer, self._left = self._left, []
        try:
            yield
        finally:
            left, self._left = self._left, outer
            self.running[id(function)] -= 1
            del self.guards[guards:]
        if left:
            self._rejoin(left, ("return",))
