"""Static checks of a program against a set of capabilities.

Problems follow from the program and the capabilities alone. Doubts are based on the computation graph: parts that may
have no effect although the robot has the capabilities.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Final

import msgspec

from kg.errors import Place, RobotError
from kg.robot.driving.ways import choose, doubts_of
from kg.robot.programs import kinds, tree, values
from kg.robot.programs.events import Problem
from kg.robot.programs.kinds import ANY, BOOLEAN, PLACE, TIME, Kind, Kinds
from kg.robot.programs.names import AT, CapabilityIndex, takes_place
from kg.robot.programs.units import PLAIN
from kg.robot.programs.write import written
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kg.robot.capability import Capabilities, Capability, Parameter
    from kg.robot.connection import ComputationGraph, GraphProblem


def collisions(
    statement: tree.Parallel | tree.OnEvent, path: str, index: CapabilityIndex
) -> Iterator[tuple[str, str, bool]]:
    """Yield conflicts of parallel parts over one target: path of the later one, description, whether it is certain."""
    parts: list[list[tuple[str, Capability]]] = []
    for part, body in tree.sequences_of(statement):
        parts.append([])
        for where, inner in tree.statements(body, f"{path}/{part}"):
            with suppress(RobotError):
                if isinstance(inner, tree.Do):
                    parts[-1].append((where, index.write(inner.capability)))

    def ends(capability: Capability) -> set[tuple[str, str]]:
        return {(way.kind, way.name) for way in capability.ways}

    reported = set()
    for earlier, later in combinations(parts, 2):
        for _, one in earlier:
            for where, other in later:
                same = one.name == other.name or not ends(one).isdisjoint(ends(other))
                one_part = one.moves is not None and one.moves == other.moves
                if (same or one_part) and where not in reported:
                    reported.add(where)
                    both = f"`{one.label}`" if one.name == other.name else f"`{one.label}` and `{other.label}`"
                    what = "is" if one.name == other.name else "are"
                    yield where, f"{both} {what} done in two parts that run at the same time", same


_SLACK: Final = 1e-9


def check(program: tree.Program, capabilities: Capabilities, places: Iterable[str] = ()) -> list[Problem]:
    """Return the problems of a program for a system, sorted by path; a program with an `error` must not be run.

    `places` are the names already resolved in the program; they are suggested for misspelt names.
    """
    checker = _Checker(capabilities, places)
    checker.program(program)

    def order(problem: Problem) -> list[tuple[int, str]]:
        return [(int(part), "") if part.isdecimal() else (-1, part) for part in problem.path.split("/")]

    return sorted(checker.problems, key=order)


def refuse_errors(program: tree.Program, capabilities: Capabilities, place: Callable[[str], Place] | None) -> None:
    """Raise the first error of a program as RobotError; `place` returns the place of a part in its file."""
    for problem in check(program, capabilities):
        if problem.severity == "error":
            where = place(problem.path) if place else None
            raise RobotError(problem.code, problem.message, place=where, hint=problem.hint)


def kinds_of(program: tree.Program, capabilities: Capabilities) -> Kinds:
    """Return the kinds of a program's expressions, with its variables; nothing is reported."""
    checker = _Checker(capabilities)
    checker.program(program)
    return checker.kinds


@dataclass(slots=True)
class _Loop:
    left: bool = False


@dataclass(frozen=True, slots=True)
class _Flow:
    """The control flow: variables that have a value, the enclosing loop, and whether movements are bounded."""

    assigned: frozenset[str] = frozenset()
    loop: _Loop | None = None
    ended: bool = False
    """Whether an enclosing statement ends an endless movement."""
    over: bool = False
    """Whether the following statements are unreachable."""


class _Checker:
    def __init__(self, capabilities: Capabilities, places: Iterable[str] = ()) -> None:
        self._places = tuple(places)
        self.problems: list[Problem] = []
        self._index = CapabilityIndex(capabilities)
        self._variables: dict[str, Kind] = {}
        self.kinds = Kinds(self._index, self._variables, self.report)
        self._ids: dict[str, str | None] = {}
        self._met: set[str] = set()

    def program(self, program: tree.Program) -> None:
        """Check a whole program."""
        self._variables.update(dict.fromkeys(_given(program.body), ANY))
        self.sequence(program.body, "/body", _Flow())
        if program.seconds is not None and program.seconds <= 0:
            self._wrong("/seconds", "the time limit of the program must be positive", code="KG835")

    def report(self, path: str, error: RobotError, severity: str = "error") -> None:
        """Report a problem at a path, once; its statement has been visited before."""
        above = path
        while above and above not in self._ids:
            above = above.rpartition("/")[0]
        problem = Problem.of(error, path, self._ids.get(above))
        if severity == "warning":
            problem = msgspec.structs.replace(problem, severity="warning")
        if problem not in self.problems:
            self.problems.append(problem)

    def _wrong(self, path: str, message: str, hint: str | None = None, code: str = "KG836") -> None:
        self.report(path, RobotError(code, message, hint=hint))

    def _warn(self, path: str, message: str, hint: str | None = None) -> None:
        self.report(path, RobotError("KG836", message, hint=hint), "warning")

    def sequence(self, body: tuple[tree.Statement, ...], path: str, flow: _Flow) -> _Flow:
        """Check a sequence of statements; return the flow after it."""
        reported = flow.over
        for number, statement in enumerate(body):
            here = f"{path}/{number}"
            self._ids[here] = statement.id
            if flow.over and not reported:
                self._warn(here, "this is never reached", "The statement before it ends the program or never ends.")
                reported = True
            after = self._statement(statement, here, replace(flow, over=False))
            flow = replace(after, over=flow.over or after.over)
        return flow

    def _statement(self, statement: tree.Statement, path: str, flow: _Flow) -> _Flow:
        self._set_before(statement, path, flow)
        match statement:
            case tree.Do():
                return self._do(statement, path, flow)
            case tree.Set():
                self._gets(statement.variable, self.kinds.of(statement.value, f"{path}/value"), path)
                return replace(flow, assigned=flow.assigned | {statement.variable})
            case tree.If():
                return self._if(statement, path, flow)
            case tree.While() | tree.Forever() | tree.Repeat() | tree.For():
                return self._loop(statement, path, flow)
            case tree.Break():
                if flow.loop is None:
                    self._wrong(path, "`break` outside a loop", "It leaves the innermost loop around it.")
                else:
                    flow.loop.left = True
                return replace(flow, over=True)
            case tree.Stop():
                return replace(flow, over=True)
            case tree.Wait():
                self._time(statement.seconds, f"{path}/seconds")
            case tree.WaitUntil():
                return self._wait_until(statement, path, flow)
            case tree.Parallel():
                return self._parallel(statement, path, flow)
            case tree.OnEvent():
                return self._on_event(statement, path, flow)
            case _:
                self.kinds.of(statement.message, f"{path}/message")
        return flow

    def _set_before(self, statement: tree.Statement, path: str, flow: _Flow) -> None:
        """Report variables that have a value only on another path of the control flow."""
        for part, expression in tree.expressions_of(statement):
            for name in tree.variables_of(expression):
                if name not in self._variables or name in flow.assigned:
                    continue
                hint = f"Give it one on every way to here: `set {written(tree.Variable(name=name))} to ...`."
                if name in self._met:
                    self._warn(f"{path}/{part}", f"the variable `{name}` may have no value here", hint)
                else:
                    self._wrong(f"{path}/{part}", f"the variable `{name}` has no value yet", hint)

    def _gets(self, variable: str, kind: Kind, path: str) -> None:
        self._met.add(variable)
        before = self._variables.setdefault(variable, kind)
        if before == ANY:
            self._variables[variable] = kind
        elif kind not in {before, ANY}:
            self._wrong(path, f"`{variable}` is {before} elsewhere, and becomes {kind} here", code="KG833")

    def _condition(self, expression: tree.Expression, path: str) -> None:
        kind = self.kinds.of(expression, path)
        if kind not in {ANY, BOOLEAN}:
            hint = "A condition compares: `nearest of laserScanning < 0.5 m`."
            self._wrong(path, f"a condition must be true or false, but this is {kind}", hint, "KG833")

    def _time(self, expression: tree.Expression | None, path: str) -> None:
        if expression is None:
            return
        kind = self.kinds.of(expression, path)
        if kind not in {ANY, TIME, Kind("number")}:
            self._wrong(path, f"this should be a time, and is {kind}", "Write `2 s`, `500 ms` or `1 min`.", "KG833")
            return
        always = kinds.constant(expression)
        if always is not None and always.value <= 0:
            self._wrong(path, f"a time must be positive, but this is {values.shown(always)}", code="KG835")

    def _number(self, expression: tree.Expression | None, path: str) -> Kind:
        kind = ANY if expression is None else self.kinds.of(expression, path)
        if kind.name not in {"any", "number"}:
            self._wrong(path, f"this should be a number, and is {kind}", code="KG833")
        return kind

    def _do(self, statement: tree.Do, path: str, flow: _Flow) -> _Flow:
        self._time(statement.seconds, f"{path}/seconds")
        self._time(statement.within, f"{path}/within")
        try:
            capability = self._index.write(statement.capability)
        except RobotError as error:
            self.report(path, error)
            for name, value in statement.arguments.items():
                self.kinds.of(value, f"{path}/arguments/{name}")
            return flow
        self._arguments(statement, capability, path)
        return self._ending(statement, capability, path, flow)

    def _ending(self, statement: tree.Do, capability: Capability, path: str, flow: _Flow) -> _Flow:
        if not capability.ways:
            return flow
        renewed = capability.ways[0].kind == "topic" and capability.ways[0].rate > 0
        if statement.seconds is not None and not renewed:
            hint = "Write `within 60 s` to give up when it takes longer."
            self._warn(f"{path}/seconds", f"`{capability.label}` ends by itself", hint)
        if statement.within is not None and capability.ways[0].kind == "topic":
            instead = "Write `for 2 s` to set how long it runs." if renewed else None
            self._warn(f"{path}/within", f"`{capability.label}` has no end, so it cannot time out", instead)
        if not renewed or statement.seconds is not None:
            return flow
        if not flow.ended:
            hint = "Write `for 2 s` after it, or put it into `as soon as ... during`."
            self._warn(path, f"`{capability.label}` runs until the program ends", hint)
        return replace(flow, over=True)

    def _arguments(self, statement: tree.Do, capability: Capability, path: str) -> None:
        given: set[str] = set()
        placed: set[str] = set()
        for name, value in statement.arguments.items():
            here = f"{path}/arguments/{name}"
            if takes_place(capability, name) and isinstance(value, tree.Variable) and value.name not in self._variables:
                hint = (
                    f"Say where it is: `set {written(value)} to (x: 2 m, y: 1.5 m)`, or in a file (`--places`), "
                    "or name the robot that defines it (`--robot`)."
                )
                suggestion = did_you_mean(value.name, [*self._variables, *self._places])
                self._wrong(here, f"no place is called `{value.name}`", suggestion or hint)
                placed = {"x", "y", "z"}
                continue
            kind = self.kinds.of(value, here)
            if takes_place(capability, name):
                if kind not in {ANY, PLACE}:
                    hint = "A place is written `(x: 2 m, y: 1.5 m, heading: 90 deg)`, or has a name."
                    self._wrong(here, f"`{name}` must be a place, but this is {kind}", hint, "KG833")
                placed = set(value.parts()) if isinstance(value, tree.Position) else {"x", "y", "z"}
                self._place(capability, value, here)
                continue
            try:
                parameter = self._index.parameter(capability, name)
            except RobotError as error:
                self.report(here, error)
                continue
            if parameter.name in given:
                self._wrong(here, f"`{parameter.name}` is given twice", code="KG832")
            given.add(parameter.name)
            self._argument(parameter, kind, value, here)
        for parameter in capability.parameters:
            if parameter.name not in given | placed and parameter.default is None and not parameter.optional:
                of_place = takes_place(capability, AT) and parameter.name in {"x", "y"}
                hint = f"Write `{parameter.name}: ...` after it{f', or `{AT}:` and a place' if of_place else ''}."
                self._wrong(path, f"`{capability.label}` needs its `{parameter.name}`", hint, "KG832")

    def _place(self, capability: Capability, value: tree.Expression, path: str) -> None:
        always = kinds.constant(value)
        components = values.of_place(always) if always is not None and isinstance(always.value, dict) else {}
        for parameter in capability.parameters:
            if parameter.name in components:
                self._limits(parameter, values.for_parameter(parameter, components[parameter.name]), path)

    def _argument(self, parameter: Parameter, kind: Kind, value: tree.Expression, path: str) -> None:
        wanted = kinds.of_parameter(parameter)
        plain = kind == Kind("number", PLAIN) and wanted.name == "number"
        if ANY not in {kind, wanted} and kind != wanted and not plain:
            unit = f"It is in {parameter.unit}." if parameter.unit and kind.name == "number" else None
            self._wrong(path, f"`{parameter.name}` must be {wanted}, but this is {kind}", unit, "KG833")
            return
        always = kinds.constant(value)
        if always is not None:
            self._limits(parameter, values.for_parameter(parameter, always), path)

    def _limits(self, parameter: Parameter, value: object, path: str) -> None:
        unit = f" {parameter.unit}" if parameter.unit else ""
        if parameter.choices and isinstance(value, str) and value not in parameter.choices:
            hint = f"It is one of: {', '.join(parameter.choices)}."
            self._wrong(path, f"`{value}` is not a choice of `{parameter.name}`", hint, "KG835")
        if isinstance(value, bool) or not isinstance(value, int | float):
            return
        if parameter.type == "integer" and value != int(value):
            self._wrong(path, f"`{parameter.name}` must be a whole number, but this is {value:g}", code="KG835")
        if parameter.minimum is not None and value < parameter.minimum - _SLACK:
            least = f"{parameter.minimum:g}{unit}"
            self._wrong(path, f"`{parameter.name}` must be at least {least}, but this is {value:g}{unit}", code="KG835")
        if parameter.maximum is not None and value > parameter.maximum + _SLACK:
            most = f"{parameter.maximum:g}{unit}"
            self._wrong(path, f"`{parameter.name}` must be at most {most}, but this is {value:g}{unit}", code="KG835")

    def _if(self, statement: tree.If, path: str, flow: _Flow) -> _Flow:
        self._condition(statement.condition, f"{path}/condition")
        then = self.sequence(statement.then, f"{path}/then", flow)
        otherwise = self.sequence(statement.otherwise, f"{path}/otherwise", flow)
        # A branch that ends the program says nothing about the statements after the condition.
        assigned = {(False, False): then.assigned & otherwise.assigned, (True, False): otherwise.assigned}
        both = assigned.get((then.over, otherwise.over), then.assigned)
        return replace(flow, assigned=both, over=then.over and otherwise.over)

    def _loop(self, statement: tree.Loop, path: str, flow: _Flow) -> _Flow:
        loop = _Loop()
        inside = replace(flow, loop=loop)
        runs = False
        forever = False
        match statement:
            case tree.While():
                self._condition(statement.condition, f"{path}/condition")
                always = isinstance(statement.condition, tree.Written) and statement.condition.value is True
                runs = forever = always
                self._waits(statement, path)
            case tree.Forever():
                runs = forever = True
                self._waits(statement, path)
            case tree.Repeat():
                runs = self._times(statement, path)
            case tree.For():
                self._for(statement, path)
                inside = replace(inside, assigned=inside.assigned | {statement.variable})
        self._met |= _given(statement.body)
        after = self.sequence(statement.body, f"{path}/body", inside)
        assigned = after.assigned if runs and not loop.left else flow.assigned
        stuck = (forever and not loop.left) or (runs and after.over and not loop.left)
        return replace(flow, assigned=assigned, over=stuck)

    def _times(self, statement: tree.Repeat, path: str) -> bool:
        """Check the number of repetitions; return whether the body certainly runs."""
        kind = self._number(statement.times, f"{path}/times")
        if kind.name == "number" and kind.dimension:
            hint = "For durations, use `wait`, or `for 2 s` after a movement."
            self._wrong(
                f"{path}/times", f"the number of repetitions must be a plain number, but this is {kind}", hint, "KG833"
            )
        times = kinds.constant(statement.times)
        if times is None or not times.number:
            return False
        if times.value < 0 or times.value != int(times.value):
            self._wrong(f"{path}/times", f"a block cannot be repeated {values.shown(times)} times", code="KG835")
        elif times.value == 0:
            self._warn(f"{path}/times", "this is repeated no times")
        return bool(times.value >= 1)

    def _for(self, statement: tree.For, path: str) -> None:
        if statement.of is not None:
            kind = self.kinds.of(statement.of, f"{path}/of")
            if kind.name not in {"any", "list"}:
                self._wrong(f"{path}/of", f"this should be a list, and is {kind}", code="KG833")
            self._gets(statement.variable, ANY, path)
            return
        first = self._number(statement.start, f"{path}/start")
        for part, expression in (("end", statement.end), ("step", statement.step)):
            kind = self._number(expression, f"{path}/{part}") if expression is not None else first
            if "any" not in {first.name, kind.name} and kind != first:
                self._wrong(f"{path}/{part}", f"this is {kind}, and the beginning is {first}", code="KG833")
        step = kinds.constant(statement.step)
        if step is not None and step.value == 0:
            self._wrong(f"{path}/step", "with a step of zero the end is never reached", code="KG835")
        self._gets(statement.variable, first, path)

    def _waits(self, statement: tree.While | tree.Forever, path: str) -> None:
        """Report a busy loop: it does not wait, does nothing, and does not change its own condition."""
        within = [inner for _, inner in tree.statements(statement.body)]
        if any(isinstance(inner, tree.Do | tree.Wait | tree.WaitUntil) for inner in within):
            return
        given = {inner.variable for inner in within if isinstance(inner, tree.Set)}
        conditions = [statement.condition] if isinstance(statement, tree.While) else []
        reads = [one for condition in conditions for one in tree.reads_of(condition)]
        used = {name for condition in conditions for name in tree.variables_of(condition)}
        left = any(isinstance(inner, tree.Break | tree.Stop) for inner in within)
        if reads or not (left or given & used):
            self._wrong(path, "this loop does nothing and does not wait", "Put `wait 0.1 s` into it.")

    def _wait_until(self, statement: tree.WaitUntil, path: str, flow: _Flow) -> _Flow:
        self._condition(statement.condition, f"{path}/condition")
        self._time(statement.seconds, f"{path}/seconds")
        if statement.otherwise is not None:
            if statement.seconds is None:
                hint = "Write `within 10 s` before `otherwise`."
                self._warn(f"{path}/otherwise", "this is never done: the wait has no end", hint)
            self.sequence(statement.otherwise, f"{path}/otherwise", flow)
        reads = any(isinstance(part, tree.Read | tree.Variable) for part in tree.parts_of(statement.condition))
        may_change = reads and not isinstance(statement.condition, tree.Variable)
        if statement.seconds is None and not flow.ended and not may_change:
            self._warn(path, "nothing can make this true while it waits")
        return flow

    def _parallel(self, statement: tree.Parallel, path: str, flow: _Flow) -> _Flow:
        self._met |= _given((statement,))
        branches = []
        for part, branch in tree.sequences_of(statement):
            branches.append(self.sequence(branch, f"{path}/{part}", replace(flow, loop=None)))
        if len(statement.branches) <= 1:
            self._warn(path, "no blocks to run at the same time", "Put `also` between what runs together.")
        for where, message, surely in collisions(statement, path, self._index):
            (self._wrong if surely else self._warn)(where, message, "A robot can follow one command at a time.")
        assigned = flow.assigned.union(*(branch.assigned for branch in branches))
        return replace(flow, assigned=assigned, over=any(branch.over for branch in branches))

    def _on_event(self, statement: tree.OnEvent, path: str, flow: _Flow) -> _Flow:
        self._condition(statement.condition, f"{path}/condition")
        around = replace(flow, loop=None)
        self._met |= _given((statement,))
        body = self.sequence(statement.body, f"{path}/body", replace(around, ended=flow.ended or statement.end))
        then = self.sequence(statement.then, f"{path}/then", around)
        if not statement.end:
            for where, message, _ in collisions(statement, path, self._index):
                self._warn(where, message, "Use `as soon as`, which ends the one before it does the other.")
            return replace(flow, assigned=body.assigned, over=body.over)
        return replace(flow, over=then.over and body.over)


def _given(body: tuple[tree.Statement, ...]) -> set[str]:
    return {statement.variable for _, statement in tree.statements(body) if isinstance(statement, tree.Set | tree.For)}


_MISFITS: Final = frozenset({"KG806", "KG815"})
"""The codes of mismatched types and qualities of service, with which ends of a topic are not connected."""


def doubts(program: tree.Program, capabilities: Capabilities, graph: ComputationGraph) -> list[Problem]:
    """Return warnings for capabilities whose topics have no subscriber or publisher among the live nodes.

    Each is reported once, at the first block that uses it. Missing capabilities are reported by `check`.
    """
    index = CapabilityIndex(capabilities)
    reported: set[GraphProblem] = set()
    problems = []
    for path, statement in tree.statements(program.body):
        used = [(path, index.write, statement.capability)] if isinstance(statement, tree.Do) else []
        for part, expression in tree.expressions_of(statement):
            used += [(f"{path}/{part}", index.read, read.capability) for read in tree.reads_of(expression)]
        for where, look_up, name in used:
            with suppress(RobotError):
                capability = look_up(name)
                for doubt in _of(capability, graph):
                    if doubt not in reported:
                        reported.add(doubt)
                        message = f"`{capability.label}` may have no effect: {doubt.subject}: {doubt.message}"
                        problem = Problem(
                            id=statement.id, path=where, message=message, code=doubt.code, severity="warning"
                        )
                        problems.append(problem)
    return problems


def _of(capability: Capability, graph: ComputationGraph) -> Iterator[GraphProblem]:
    reads = capability.modality == "read"
    ways = [one for one in capability.ways if not (reads and one.kind == "action")]
    if not ways:
        return
    way = choose(ways, (), graph, reads=reads)
    yield from doubts_of(way, graph, reads=reads)
    if way.kind == "topic":
        yield from (one for one in graph.problems if one.code in _MISFITS and one.subject == way.name)
