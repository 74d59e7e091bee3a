"""Import of behaviour trees as programs.

Trees written by `exporting` become the original statements; other trees are imported as far as their nodes are
equivalent to statements. A statement's text (`_kg`) is used as long as it agrees with the nodes. Numbers have no units
in trees; they get those of the values that they are compared with or added to.
"""

from __future__ import annotations

from contextlib import suppress
from math import isclose
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.errors import Place, RobotError
from kg.robot.programs import tree
from kg.robot.programs.check import kinds_of
from kg.robot.programs.names import CapabilityIndex
from kg.robot.programs.parse import parse
from kg.robot.programs.trees.exporting import DURATION, HINT, PLACE, port
from kg.robot.programs.trees.scripts import COUNT, OWN, Bare, ScriptError, assignments, counted, expression_of, reading
from kg.robot.programs.units import UNITS, Dimension, described
from kg.xmltext import line_of, parse_xml

if TYPE_CHECKING:
    from lxml.etree import _Element

    from kg.robot.capability import Capabilities

_ALIKE: Final = frozenset({"<", "<=", "=", "!=", ">=", ">", "+", "-"})


def with_units(program: tree.Program, capabilities: Capabilities) -> tree.Program:
    """Return a program in which plain numbers have the base unit of their neighbour."""
    kinds = kinds_of(program, capabilities)

    def change(part: dict[str, Any]) -> Any:
        if part.get("expression") != "binary" or part["operator"] not in _ALIKE:
            return part
        binary = msgspec.convert(part, tree.Binary)
        left, right = kinds.of(binary.left, ""), kinds.of(binary.right, "")
        if left.name != "number" or right.name != "number" or bool(left.dimension) == bool(right.dimension):
            return part
        dimension = left.dimension or right.dimension
        united = msgspec.structs.replace(binary, left=_in(binary.left, dimension), right=_in(binary.right, dimension))
        return msgspec.to_builtins(united)

    return tree.rewritten(program, change)


def _in(expression: tree.Expression, dimension: Dimension) -> tree.Expression:
    unit = described(dimension)
    match expression:
        case tree.Written(value=value, unit=None) if unit in UNITS and value and not isinstance(value, bool | str):
            return tree.Written(value=value, unit=unit)
        case tree.Unary(operator="-" | "absolute"):
            return msgspec.structs.replace(expression, of=_in(expression.of, dimension))
    return expression


_IGNORED: Final = frozenset({"name", "ID", "_autoremap", "_description", "_fullpath", "_uid", "_collapsed", HINT})
_EXPLICIT: Final = frozenset({"Action", "Condition", "Control", "Decorator"})
_NODES: Final = frozenset(
    {"AlwaysFailure", "AsyncFallback", "AsyncSequence", "Delay", "Fallback", "ForceFailure", "ForceSuccess"}
    | {"IfThenElse", "Inverter", "KeepRunningUntilFailure", "LoopBool", "LoopDouble", "LoopInt", "LoopString"}
    | {"Parallel", "ParallelAll", "Precondition", "ReactiveFallback", "ReactiveSequence", "Repeat"}
    | {"RetryUntilSuccessful", "RunOnce", "Script", "ScriptCondition", "SequenceWithMemory", "SetBlackboard"}
    | {"SkipUnlessUpdated", "Sleep"}
    | {"SubTree", "Switch2", "Switch3", "Switch4", "Switch5", "Switch6", "Timeout", "TryCatch", "UnsetBlackboard"}
    | {"WaitValueUpdate", "WasEntryUpdated", "WhileDoElse"}
)
"""Standard nodes that are not statements on their own; capabilities have other names."""
_PAIR: Final = 2
_TRIPLE: Final = 3  # number of children of a ternary node
_ENDS: Final = ("\nend", "\nduring\nend", "")  # endings that complete the first line of a statement
_Env = dict[str, tree.Expression]


def program_of(text: str | bytes, capabilities: Capabilities, path: str = "tree") -> tree.Program:
    """Return the program of a behaviour tree.

    Raises:
        RobotError: KG842 at the line that is not part of a behaviour tree of version 4, or has no equivalent statement.
    """
    parsed = parse_xml(text.encode() if isinstance(text, str) else text)
    if parsed.root is None or parsed.problem is not None:
        _, message, line = parsed.problem or ("", "is empty", 1)
        raise RobotError("KG842", f"the XML {message}", place=Place(path, line))
    try:
        program = _Reader(parsed.root, capabilities, path).program()
        return with_units(program, capabilities)
    except RecursionError:
        raise RobotError("KG842", "the tree is nested too deeply", place=Place(path)) from None


def _children(node: _Element) -> list[_Element]:
    return list(node.iterchildren("*"))


class _Reader:
    def __init__(self, root: _Element, capabilities: Capabilities, path: str) -> None:
        self._root = root
        self._path = path
        self._capabilities = capabilities
        self._index = CapabilityIndex(capabilities)
        self._flags: list[tuple[str, str]] = []
        self._within: list[str] = []
        self._depth = 0
        models = [model for one in root.findall("TreeNodesModel") for model in _children(one)]
        self._outputs = {
            str(model.get("ID")): {str(one.get("name")) for one in model.findall("output_port")} for model in models
        }

    def program(self) -> tree.Program:
        """Return the main tree as a program."""
        if self._root.tag != "root" or self._root.get("BTCPP_format") != "4":
            hint = 'It begins with `<root BTCPP_format="4">`; BehaviorTree.CPP converts older ones.'
            raise self._refused(self._root, "this is not a behaviour tree of BehaviorTree.CPP 4", hint)
        trees = {str(one.get("ID")): one for one in self._root.findall("BehaviorTree")}
        main = self._root.get("main_tree_to_execute") or (next(iter(trees)) if len(trees) == 1 else None)
        if main is None or main not in trees:
            raise self._refused(self._root, f"unknown tree `{main}`" if main else "no tree is the main one")
        self._trees = trees
        self._within.append(main)
        node, seconds = self._only(trees[main]), None
        if node.tag == "Timeout" and self._statement_of_timeout(self._only(node)) is None:
            seconds, node = self._seconds(node, "msec"), self._only(node)
        flag = self._leavable(node)
        if flag is not None and not self._is_loop(self._guarded(node)):
            self._flags.append((flag, "program"))
            node = self._guarded(node)
        name = str(trees[main].get(HINT) or main)
        body = self._body(node, {})
        return tree.Program(name=name, comment=trees[main].get("_description", ""), seconds=seconds, body=body)

    def _refused(self, node: _Element, message: str, hint: str | None = None) -> RobotError:
        return RobotError("KG842", message, place=Place(self._path, line_of(node)), hint=hint)

    def _only(self, node: _Element) -> _Element:
        children = _children(node)
        if len(children) != 1:
            raise self._refused(node, f"<{node.tag}> must have one child, and has {len(children)}")
        return children[0]

    def _name(self, node: _Element) -> str:
        return str(node.get("ID") or "") if node.tag in _EXPLICIT else str(node.tag)

    def _ports(self, node: _Element) -> dict[str, str]:
        for key in map(str, node.attrib):
            if key.startswith("_") and key not in _IGNORED:
                raise self._refused(node, f"programs have no `{key}` of a node", "Use a node in its place.")
        return {key: node.get(key, "") for key in map(str, node.attrib) if key not in _IGNORED}

    def _script(self, node: _Element, code: str, env: _Env) -> tree.Expression:
        try:
            return expression_of(code, env)
        except ScriptError as error:
            raise self._refused(node, str(error)) from error

    def _port(self, node: _Element, value: str, env: _Env) -> tree.Expression:
        """Return the value of a port: a variable in braces, a place, a number, a truth value or a text."""
        if value.startswith("{") and value.endswith("}"):
            return self._script(node, value[1:-1], env)
        if place := _place(value):
            return place
        with suppress(ValueError, ScriptError):
            return tree.Written(value=float(value))
        return tree.Written(value={"true": True, "false": False}.get(value, value))

    def _seconds(self, node: _Element, name: str) -> float:
        text = node.get(name, "")
        if not text.isdecimal():
            raise self._refused(node, f"`{name}` of <{node.tag}> must be a whole number, but is `{text}`")
        return int(text) / 1000

    def _body(self, node: _Element, env: _Env) -> tuple[tree.Statement, ...]:
        if self._name(node) == "AlwaysSuccess":
            return ()
        self._depth += 1
        if self._depth > 2 * tree.BLOCKS_DEEP:
            raise self._refused(node, "the tree is nested too deeply")
        try:
            if self._name(node) == "Sequence" and node.get(HINT) is None:
                return self._sequence(node, env)
            return self._statements(node, env)
        finally:
            self._depth -= 1

    def _sequence(self, node: _Element, env: _Env) -> tuple[tree.Statement, ...]:
        inner = dict(env)
        return tuple(one for child in _children(node) for one in self._statements(child, inner))

    def _statements(self, node: _Element, env: _Env) -> tuple[tree.Statement, ...]:
        """Return the statements of a node, with the text of its hint if that is still accurate."""
        statements = self._structural(node, env)
        hint = node.get(HINT)
        if len(statements) != 1 or hint is None:
            return statements
        return (self._hinted(statements[0], hint, node.get("_description", "")),)

    def _structural(self, node: _Element, env: _Env) -> tuple[tree.Statement, ...]:
        name = self._name(node)
        if name == "Sequence":
            pattern = self._pattern(node, env)
            return self._sequence(node, env) if pattern is None else (pattern,)
        if name == "AlwaysSuccess":
            return ()
        if name == "SubTree":
            return self._subtree(node, env)
        if name == "Script":
            return self._assigned(node, env)
        if name in self._outputs and self._outputs[name] & self._ports(node).keys():
            return self._read(node, name, env)
        return (self._statement(node, name, env),)

    def _statement(self, node: _Element, name: str, env: _Env) -> tree.Statement:
        ports = self._ports(node)
        match name:
            case "IfThenElse":
                return self._if(node, env)
            case "KeepRunningUntilFailure":
                return tree.Forever(body=self._body(self._only(node), env))
            case "Repeat":
                times = self._port(node, ports.get("num_cycles", ""), env)
                if times == tree.Written(value=-1.0):
                    return tree.Forever(body=self._body(self._only(node), env))
                return tree.Repeat(times=times, body=self._body(self._only(node), env))
            case "LoopDouble" | "LoopInt":
                return self._loop(node, ports, env)
            case "Sleep":
                return tree.Wait(seconds=tree.Written(value=self._seconds(node, "msec")))
            case "RetryUntilSuccessful":
                return self._until(node, env)
            case "Fallback":
                return self._otherwise(node, env)
            case "Timeout":
                if self._statement_of_timeout(self._only(node)) is None:
                    hint = "A program has a time limit for a capability, for `wait until`, and for itself."
                    raise self._refused(node, "this limits the time of several nodes", hint)
                return self._limited(node, env)
            case "Parallel" | "ParallelAll":
                return self._parallel(node, ports, env)
            case "Log":
                return self._log(node, ports, env)
        if name in _NODES or _children(node):
            raise self._refused(node, f"no statement means <{name}> here")
        return self._do(node, name, ports, env)

    def _statement_of_timeout(self, node: _Element) -> str | None:
        """Return the name of the statement with a time limit; None if the limit is that of a whole sequence."""
        name = self._name(node)
        return name if name == "RetryUntilSuccessful" or not _children(node) else None

    def _limited(self, node: _Element, env: _Env) -> tree.Statement:
        seconds = tree.Written(value=self._seconds(node, "msec"))
        inner = self._statement(self._only(node), self._name(self._only(node)), env)
        if isinstance(inner, tree.WaitUntil):
            return msgspec.structs.replace(inner, seconds=seconds)
        if isinstance(inner, tree.Do):
            return msgspec.structs.replace(inner, within=seconds)
        raise self._refused(node, "only capabilities and `wait until` have a time limit")

    # Statements of several nodes

    def _leavable(self, node: _Element) -> str | None:
        """Return the flag of nodes that can be left: a flag, then a Fallback of the nodes and the flag."""
        children = _children(node)
        if self._name(node) != "Sequence" or len(children) != _PAIR or self._name(children[1]) != "Fallback":
            return None
        flag = str(children[0].get("code", "")).partition(" := ")[0]
        guarded = _children(children[1])
        same = len(guarded) == _PAIR and guarded[1].tag == "ScriptCondition" and guarded[1].get("code") == flag
        return flag if same and children[0].tag == "Script" and flag.startswith(OWN) else None

    @staticmethod
    def _guarded(node: _Element) -> _Element:
        return _children(_children(node)[1])[0]

    def _is_loop(self, node: _Element) -> bool:
        return self._name(node) in {"KeepRunningUntilFailure", "Repeat", "LoopDouble", "LoopInt"}

    def _pattern(self, node: _Element, env: _Env) -> tree.Statement | None:
        """Return the statement of a whole Sequence, if there is one."""
        children = _children(node)
        names = [self._name(child) for child in children]
        if names == ["Script", "AlwaysFailure"]:
            return self._leaving(node, str(children[0].get("code")))
        if names == ["Script", "ReactiveFallback", "IfThenElse"]:
            return self._event(children, env)
        flag = self._leavable(node)
        if flag is None or not self._is_loop(self._guarded(node)):
            return None
        self._flags.append((flag, "loop"))
        try:
            return self._left_loop(self._guarded(node), flag, env)
        finally:
            self._flags.pop()

    def _left_loop(self, node: _Element, flag: str, env: _Env) -> tree.Statement:
        turn = _children(node)[0]
        parts = _children(turn)
        if self._name(node) == "KeepRunningUntilFailure" and turn.tag == "IfThenElse" and len(parts) == _TRIPLE:
            ends = [child.get("code") for child in _children(parts[2])] == [f"{flag} := true", None]
            if ends and turn.get(HINT) is None:
                return tree.While(condition=self._condition(parts[0], env), body=self._body(parts[1], env))
        return self._statement(node, self._name(node), env)

    def _leaving(self, node: _Element, code: str) -> tree.Statement:
        flag = code.partition(" := ")[0]
        kinds = dict(self._flags)
        if kinds.get(flag) == "program":
            return tree.Stop()
        if self._flags and self._flags[-1] == (flag, "loop"):
            return tree.Break()
        raise self._refused(node, "this fails, and programs have no statement that fails")

    def _event(self, children: list[_Element], env: _Env) -> tree.Statement:
        flag = str(children[0].get("code", "")).partition(" := ")[0]
        watched, after = _children(children[1]), _children(children[2])
        if len(watched) != _PAIR or len(after) < _PAIR or after[0].get("code") != flag:
            raise self._refused(children[1], "no statement means <ReactiveFallback> here")
        condition = _children(watched[0])[0]
        around = self._flags
        self._flags = [one for one in self._flags if one[1] == "program"]
        try:
            then, body = self._body(after[1], env), self._body(watched[1], env)
        finally:
            self._flags = around
        return tree.OnEvent(condition=self._condition(condition, env), then=then, body=body, end=True)

    # Statements of one node

    def _condition(self, node: _Element, env: _Env) -> tree.Expression:
        name = self._name(node)
        children = _children(node)
        if name == "ScriptCondition":
            return self._script(node, self._ports(node).get("code", ""), env)
        if name in {"AlwaysSuccess", "AlwaysFailure"}:
            return tree.Written(value=name == "AlwaysSuccess")
        if name == "Inverter":
            return tree.Unary(operator="not", of=self._condition(self._only(node), env))
        if name not in {"Sequence", "Fallback"} or not children:
            raise self._refused(node, f"<{name}> is not a condition that programs have")
        inner, condition = dict(env), None
        for child in children:
            child_name = self._name(child)
            if child_name in self._outputs and self._outputs[child_name] & self._ports(child).keys():
                if self._read(child, child_name, inner):
                    raise self._refused(child, "a condition that keeps what it reads")
                continue
            one = self._condition(child, inner)
            condition = (
                one
                if condition is None
                else tree.Binary(operator="and" if name == "Sequence" else "or", left=condition, right=one)
            )
        if condition is None:
            raise self._refused(node, "this reads and compares nothing")
        return condition

    def _if(self, node: _Element, env: _Env) -> tree.Statement:
        children = _children(node)
        if len(children) != _TRIPLE:
            hint = "Without a third child it fails when its condition does not hold: add <AlwaysSuccess/>."
            raise self._refused(node, "programs have no statement that fails", hint)
        condition = self._condition(children[0], env)
        return tree.If(condition=condition, then=self._body(children[1], env), otherwise=self._body(children[2], env))

    def _loop(self, node: _Element, ports: dict[str, str], env: _Env) -> tree.Statement:
        try:
            numbers = [float(one) for one in ports.get("queue", "").split(";")]
        except ValueError:
            raise self._refused(node, "the queue of a loop must be numbers", "Programs have no lists.") from None
        step = numbers[1] - numbers[0] if len(numbers) > 1 else 1.0
        even = all(isclose(numbers[0] + at * step, one, abs_tol=1e-9) for at, one in enumerate(numbers))
        if not even or not step:
            raise self._refused(node, "the numbers of a loop must be equally far from each other")
        start, end = tree.Written(value=numbers[0]), tree.Written(value=numbers[-1])
        width = None if abs(step) == 1 else tree.Written(value=abs(step))
        variable = ports.get("value", "").strip("{}")
        return tree.For(variable=variable, start=start, end=end, step=width, body=self._body(self._only(node), env))

    def _until(self, node: _Element, env: _Env) -> tree.Statement:
        if node.get("num_attempts") != "-1":
            raise self._refused(
                node, "a number of attempts", 'Programs wait until something holds: `num_attempts="-1"`.'
            )
        inner = self._only(node)
        return tree.WaitUntil(condition=self._condition(self._only(inner) if inner.tag == "Delay" else inner, env))

    def _otherwise(self, node: _Element, env: _Env) -> tree.Statement:
        children = _children(node)
        limited = self._name(children[0]) == "Timeout" if children else False
        waits = [self._name(one) for one in (*children[:1], *(_children(children[0]) if limited else []))]
        if len(children) != _PAIR or "RetryUntilSuccessful" not in waits:
            raise self._refused(node, "programs have no statement for what fails", "Only `wait until` has `otherwise`.")
        waiting = self._statement(children[0], self._name(children[0]), env)
        return msgspec.structs.replace(waiting, otherwise=self._body(children[1], env))

    def _parallel(self, node: _Element, ports: dict[str, str], env: _Env) -> tree.Statement:
        every = (ports.get("success_count", "-1"), ports.get("failure_count", "1")) == ("-1", "1")
        if self._name(node) == "ParallelAll":
            every = ports.get("max_failures", "1") == "0"
        if not every:
            raise self._refused(
                node, "all parts must succeed at the same time", "Write `<Parallel failure_count='1'>`."
            )
        return tree.Parallel(branches=tuple(self._body(child, env) for child in _children(node)))

    def _log(self, node: _Element, ports: dict[str, str], env: _Env) -> tree.Statement:
        message = tree.Written(value=ports.get("message", "")) if "message" in ports else None
        value = self._port(node, ports["value"], env) if "value" in ports else None
        if ports.get("unit") in UNITS and isinstance(value, tree.Written) and not isinstance(value.value, bool | str):
            value = tree.Written(value=value.value, unit=ports["unit"])
        if message is not None and value is not None:
            return tree.Log(message=tree.Binary(operator="+", left=message, right=value))
        return tree.Log(message=message or value or tree.Written(value=""))

    def _do(self, node: _Element, name: str, ports: dict[str, str], env: _Env) -> tree.Statement:
        seconds = self._port(node, ports.pop(DURATION), env) if DURATION in ports else None
        arguments = {key: self._port(node, value, env) for key, value in ports.items()}
        with suppress(RobotError):
            parameters = self._index.write(name).parameters
            names = {port(one.name): one.name for one in parameters}
            arguments = {names.get(key, key): value for key, value in arguments.items()}
            for parameter in parameters:  # the argument of a text parameter stays a text if it looks like a number
                given = ports.get(port(parameter.name), "{}")
                if parameter.type == "text" and not (given.startswith("{") and given.endswith("}")):
                    arguments[parameter.name] = tree.Written(value=given)
        return tree.Do(capability=name, arguments=arguments, seconds=seconds)

    def _assigned(self, node: _Element, env: _Env) -> tuple[tree.Statement, ...]:
        """Return the assignments of a script; names internal to exported trees are replaced by their values."""
        try:
            assigned = assignments(self._ports(node).get("code", ""), env)
        except ScriptError as error:
            raise self._refused(node, str(error)) from error
        statements = []
        for name, value in assigned:
            text = value.value if isinstance(value, tree.Written) else None
            place = _place(text) if isinstance(text, str) else None
            if name.startswith(OWN):
                env[name] = place or value
            else:
                statements.append(tree.Set(variable=name, value=place or value))
        return tuple(statements)

    def _read(self, node: _Element, name: str, env: _Env) -> tuple[tree.Statement, ...]:
        """Record the outputs of a reading node; their names then refer to the values just read."""
        statements = []
        try:
            names = {port(one.name): one.name for one in self._index.read(name).parameters}
        except RobotError:
            names = {}
        for key, value in self._ports(node).items():
            parameter = names.get(key, key)
            variable = value.strip("{}")
            length = key.startswith(COUNT) and key not in names
            read: tree.Expression = tree.Read(
                capability=name, parameter=key.removeprefix(COUNT) if length else parameter
            )
            read = tree.Unary(operator="count", of=read) if length else read
            if variable == reading(name, parameter):
                env[variable] = read
            else:
                statements.append(tree.Set(variable=variable, value=read))
        return tuple(statements)

    def _subtree(self, node: _Element, env: _Env) -> tuple[tree.Statement, ...]:
        """Return the statements of another tree, which shares only variables of the same names."""
        name = str(node.get("ID") or "")
        if name not in self._trees:
            raise self._refused(node, f"unknown tree `{name}`")
        if name in self._within:
            raise self._refused(node, f"the tree `{name}` contains itself", "Programs have no recursion.")
        before = []
        for key, value in self._ports(node).items():
            if value == f"{{{key}}}":
                continue
            if value.startswith("{"):
                raise self._refused(node, f"`{key}` has another name outside of the tree", "Give both the same name.")
            before.append(tree.Set(variable=key, value=self._port(node, value, env)))
        self._within.append(name)
        try:
            return (*before, *self._body(self._only(self._trees[name]), {}))
        finally:
            self._within.pop()

    # Statements from their text

    def _hinted(self, statement: tree.Statement, hint: str, comment: str) -> tree.Statement:
        """Return a statement from its text, if that agrees with its nodes."""
        for end in _ENDS:
            with suppress(RobotError):
                written = parse(f"{hint}{end}").body
                if len(written) == 1 and type(written[0]) is type(statement):
                    sequences = ("then", "otherwise", "body", "branches")
                    inner: Any = {name: getattr(statement, name) for name in sequences if hasattr(statement, name)}
                    candidate = msgspec.structs.replace(written[0], **inner)
                    if self._same(candidate, statement):
                        return msgspec.structs.replace(candidate, comment=comment)
        return msgspec.structs.replace(statement, comment=comment)

    def _same(self, candidate: tree.Statement, statement: tree.Statement) -> bool:
        kinds = kinds_of(tree.Program(body=(candidate,)), self._capabilities)
        bare = Bare(self._index, kinds)
        one, other = bare.head(candidate), bare.head(statement)
        if isinstance(one, tree.For) and isinstance(other, tree.For):
            numbers, others = counted(one) or [], counted(other) or []
            close = all(isclose(left, right, abs_tol=1e-9) for left, right in zip(numbers, others, strict=False))
            return one.variable == other.variable and len(numbers) == len(others) and close
        return one == other


def _place(text: str) -> tree.Position | None:
    """Return the place in a text: x;y, x;y;heading or x;y;z;heading."""
    match = PLACE.fullmatch(text)
    if match is None:
        return None
    try:
        numbers = [tree.Written(value=float(one)) if one else None for one in text.split(";")]
    except ValueError:
        return None
    x, y, *others = numbers
    if x is None or y is None:
        return None
    z, heading = others if len(others) == _PAIR else (None, *others, None)[:2]
    return tree.Position(x=x, y=y, z=z, heading=heading)
