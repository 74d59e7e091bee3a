"""Export of programs as behaviour trees.

Trees have no statement that leaves a loop or the program. Both become a flag on the blackboard and a failure, which
propagates to the nodes around the loop or program. There the flag turns it into success.
"""

from __future__ import annotations

import re
from itertools import count
from typing import TYPE_CHECKING, Final

from lxml import etree

from kg.errors import Place, RobotError
from kg.robot.programs import tree
from kg.robot.programs.check import kinds_of, refuse_errors
from kg.robot.programs.kinds import constant
from kg.robot.programs.names import AT, CapabilityIndex, takes_place
from kg.robot.programs.trees.scripts import COUNT, OWN, Bare, ScriptError, counted, identifier, number, reading, script
from kg.robot.programs.units import described
from kg.robot.programs.write import headline

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from lxml.etree import _Element

    from kg.robot.capability import Capabilities, Capability, Parameter

HINT: Final = "_kg"
"""The attribute with the text of a statement."""
_POLL: Final = 50  # milliseconds between evaluations of a condition that is waited for
DURATION: Final = "for_seconds"
"""The port of the duration of a movement."""
_STOPPED: Final = f"{OWN}stopped"
PLACE: Final = re.compile(r"(-?[0-9.eE+-]+);(-?[0-9.eE+-]+)(?:;(-?[0-9.eE+-]*))?(?:;(-?[0-9.eE+-]*))?")
"""A place in a port: x;y, x;y;heading or x;y;z;heading."""
_SLACK: Final = 1e-6  # maximum rounding error in milliseconds of a duration
_TYPES: Final = {"number": "double", "integer": "int", "boolean": "bool", "text": "std::string", "list": "std::string"}
_RESERVED: Final = frozenset({"name", "ID", "_autoremap"})


def port(parameter: str) -> str:
    """Return the name of the port of a parameter; BehaviorTree.CPP reserves some names."""
    return f"{parameter}_" if parameter in _RESERVED else parameter


def behavior_tree(
    program: tree.Program, capabilities: Capabilities, *, place: Callable[[str], Place] | None = None
) -> str:
    """Return a program as XML for BehaviorTree.CPP 4.

    `place` returns the place of a part of the program in its file.

    Raises:
        RobotError: the first error of an invalid program; KG841 for parts that no tree can express.
    """
    refuse_errors(program, capabilities, place)
    return _Tree(program, capabilities, place).text()


def _node(tag: str, /, *children: _Element, **attributes: str) -> _Element:
    element = etree.Element(tag, attributes)
    element.extend(children)
    return element


def _flag(name: str, value: str) -> _Element:
    return _node("Script", code=f"{name} := {value}")


def _left(flag: str) -> _Element:
    """Return nodes that set a flag and fail, up to the nodes that test the flag."""
    return _node("Sequence", _flag(flag, "true"), _node("AlwaysFailure"))


def _leavable(flag: str, inner: _Element) -> _Element:
    """Return nodes that succeed if the inner one does, or if it fails with the flag set."""
    guarded = _node("Fallback", inner, _node("ScriptCondition", code=flag))
    return _node("Sequence", _flag(flag, "false"), guarded)


def _milliseconds(seconds: tree.Expression) -> str:
    always = constant(seconds)
    if always is None:
        raise ScriptError("a time of a behaviour tree is a number, not a calculation")
    rounded = round(always.value * 1000)
    if abs(rounded - always.value * 1000) > _SLACK or not 0 < rounded < 1 << 32:
        raise ScriptError("a time of a behaviour tree is a whole number of milliseconds")
    return str(rounded)


class _Tree:
    def __init__(self, program: tree.Program, capabilities: Capabilities, place: Callable[[str], Place] | None) -> None:
        self._program = program
        self._place = place
        self._index = CapabilityIndex(capabilities)
        self._kinds = kinds_of(program, capabilities)
        self._bare = Bare(self._index, self._kinds)
        self._used: dict[str, tuple[Capability, bool]] = {}
        self._logs = False
        self._numbers = count(1)
        self._names: dict[str, str] = {}
        self._loops: list[str] = []

    def text(self) -> str:
        """Return the XML."""
        every = list(tree.statements(self._program.body))
        for path, one in every:
            self._at(path, lambda one=one: self._name_variables(one))  # type: ignore[misc] # of this turn
        body = self._body(self._program.body, "/body")
        if any(isinstance(one, tree.Stop) for _, one in every):
            body = _leavable(_STOPPED, body)
        if self._program.seconds is not None:
            limit = tree.Written(value=self._program.seconds)
            body = _node("Timeout", body, msec=self._at("/seconds", lambda: _milliseconds(limit)))
        name = "".join(char if char.isalnum() else "_" for char in self._program.name).strip("_")
        name = name if name and name.lower() != "root" and name not in self._used else f"{name}_program".strip("_")
        main = _node("BehaviorTree", body, ID=name)
        self._note(main, self._program.name, self._program.comment, "")
        root = _node("root", main, self._models(), BTCPP_format="4", main_tree_to_execute=name)
        etree.indent(root)
        return etree.tostring(root, encoding="unicode", xml_declaration=False) + "\n"

    def _at(self, path: str, make: Callable[[], str]) -> str:
        try:
            return make()
        except ScriptError as error:
            raise self._refused(str(error), path) from error

    def _refused(self, message: str, path: str) -> RobotError:
        place = self._place(path) if self._place else None
        return RobotError("KG841", f"a behaviour tree cannot express this: {message}", place=place)

    def _note(self, node: _Element, hint: str, comment: str, path: str) -> None:
        try:
            node.set(HINT, hint)
            if comment:
                node.set("_description", comment)
        except ValueError as error:
            raise self._refused("XML has no such characters", path) from error

    def _body(self, body: tuple[tree.Statement, ...], path: str) -> _Element:
        if not body:
            return _node("AlwaysSuccess")
        return _node("Sequence", *(self._statement(one, f"{path}/{number}") for number, one in enumerate(body)))

    def _statement(self, statement: tree.Statement, path: str) -> _Element:
        try:
            element = self._element(statement, path)
        except ScriptError as error:
            raise self._refused(str(error), path) from error
        except ValueError as error:
            raise self._refused("XML has no such characters", path) from error
        self._note(element, headline(statement), statement.comment, path)
        return element

    def _element(self, statement: tree.Statement, path: str) -> _Element:
        bare = self._bare.head(statement)
        match bare:
            case tree.Do():
                return self._do(bare)
            case tree.Set():
                return self._set(bare)
            case tree.If():
                branches = self._body(bare.then, f"{path}/then"), self._body(bare.otherwise, f"{path}/otherwise")
                return _node("IfThenElse", self._condition(bare.condition), *branches)
            case tree.While() | tree.Forever() | tree.Repeat() | tree.For():
                return self._loop(bare, path)
            case tree.Break():
                return _left(self._loops[-1])
            case tree.Stop():
                return _left(_STOPPED)
            case tree.Wait():
                return _node("Sleep", msec=_milliseconds(bare.seconds))
            case tree.WaitUntil():
                return self._wait_until(bare, path)
            case tree.Parallel():
                if not bare.branches:
                    raise ScriptError("nothing to do at the same time")
                parts = [self._body(one, f"{path}/branches/{number}") for number, one in enumerate(bare.branches)]
                return _node("Parallel", *parts, success_count="-1", failure_count="1")
            case tree.OnEvent():
                return self._on_event(bare, path)
            case tree.Log():
                return self._log(bare, statement)

    def _name_variables(self, statement: tree.Statement) -> str:
        """Record the names of the variables of a statement; ScriptError on a clash."""
        used = [name for _, one in tree.expressions_of(statement) for name in tree.variables_of(one)]
        for name in [*used, *([statement.variable] if isinstance(statement, tree.Set | tree.For) else [])]:
            short = identifier(name)
            if (
                self._names.setdefault(short, name) != name
                or short.startswith(OWN)
                or short.lower() in {"true", "false"}
            ):
                raise ScriptError(f"the variable `{name}` needs a name of its own, of letters, digits and `_`")
        return ""

    def _reading(self, expressions: Iterable[tree.Expression], node: _Element, *before: _Element) -> _Element:
        """Return nodes that read the inputs of expressions, then act."""
        ports_by_capability: dict[str, dict[str, str]] = {}
        for expression in expressions:
            for capability, parameter in _read_by(expression):
                name = reading(capability, parameter)
                if name in self._names:
                    raise ScriptError(f"the variable `{name}` has the name of a reading")
                ports_by_capability.setdefault(capability, {})[port(parameter)] = f"{{{name}}}"
                self._use(self._index.read(capability), done=False)
        reads = [_node(capability, **ports) for capability, ports in ports_by_capability.items()]
        return _node("Sequence", *reads, *before, node) if reads or before else node

    def _use(self, capability: Capability, *, done: bool) -> None:
        if self._used.setdefault(capability.name, (capability, done))[1] is not done:
            raise ScriptError(f"`{capability.name}` is something to do and to sense")

    def _condition(self, condition: tree.Expression) -> _Element:
        return self._reading([condition], _node("ScriptCondition", code=script(condition)))

    def _set(self, statement: tree.Set) -> _Element:
        name, value = statement.variable, statement.value
        if isinstance(value, tree.Read):
            self._use(self._index.read(value.capability), done=False)
            return _node(value.capability, **{port(value.parameter): f"{{{name}}}"})
        code = f"'{_place(value)}'" if isinstance(value, tree.Position) else script(value)
        if isinstance(value, tree.Written) and isinstance(value.value, str) and PLACE.fullmatch(value.value):
            raise ScriptError(f"the text {value.value!r} would be a place")
        return self._reading([value], _node("Script", code=f"{name} := {code}"))

    def _do(self, statement: tree.Do) -> _Element:
        capability = self._index.write(statement.capability)
        self._use(capability, done=True)
        ports, before = {}, []
        needed: list[tree.Expression] = []
        for name, value in statement.arguments.items():
            given, scripted = self._given(capability.name, name, value)
            ports[port(name)] = given
            before += scripted
            needed += [value] if scripted or isinstance(value, tree.Read) else []
            if takes_place(capability, name) and not isinstance(value, tree.Position | tree.Variable):
                raise ScriptError("a place is written out, or has a name")
        if statement.seconds is not None:
            ports[DURATION], scripted = self._given(capability.name, DURATION, statement.seconds)
            before += scripted
            needed += [statement.seconds]
        node = _node(capability.name, **ports)
        if statement.within is not None:
            node = _node("Timeout", node, msec=_milliseconds(statement.within))
        return self._reading(needed, node, *before)

    @staticmethod
    def _given(capability: str, name: str, value: tree.Expression) -> tuple[str, list[_Element]]:
        """Return the value of a port, and the script that computes it first."""
        match value:
            case tree.Written(value=bool() as truth):
                return ("true" if truth else "false"), []
            case tree.Written(value=str() as text):
                if text.startswith("{") and text.endswith("}"):
                    raise ScriptError(f"the text {text!r} would be a variable of the tree")
                return text, []
            case tree.Written(value=float() | int() as found):
                return number(found), []
            case tree.Position():
                return _place(value), []
            case tree.Variable(name=variable):
                return f"{{{variable}}}", []
            case tree.Read():
                return f"{{{reading(value.capability, value.parameter)}}}", []
        port_name = f"{OWN}{capability}_{name}"
        return f"{{{port_name}}}", [_node("Script", code=f"{port_name} := {script(value)}")]

    def _log(self, statement: tree.Log, original: tree.Statement) -> _Element:
        self._logs = True
        text, value = "", original.message if isinstance(original, tree.Log) else statement.message
        match statement.message:
            case tree.Written(value=str() as text):
                return _node("Log", message=self._given("log", "message", tree.Written(value=text))[0])
            case tree.Binary(operator="+", left=tree.Written(value=str() as text)) if isinstance(value, tree.Binary):
                value, bare = value.right, statement.message.right
                ports = {"message": self._given("log", "message", tree.Written(value=text))[0]}
            case bare:
                ports = {}
        if isinstance(bare, tree.Written) and isinstance(bare.value, str):
            raise ScriptError("a text joined to a text")
        ports["value"], before = self._given("log", "value", bare)
        if dimension := self._kinds.of(value, "").dimension:
            ports["unit"] = described(dimension)
        return self._reading([bare], _node("Log", **ports), *before)

    def _loop(self, statement: tree.Loop, path: str) -> _Element:
        flag = f"{OWN}left_{next(self._numbers)}"
        self._loops.append(flag)
        body = self._body(statement.body, f"{path}/body")
        self._loops.pop()
        # Only a `break` in the body sets the flag of this loop.
        leaves = any(str(one.get("code")).startswith(f"{flag} :=") for one in body.iter("Script"))
        before: list[_Element] = []
        match statement:
            case tree.While():
                turn = _node("IfThenElse", self._condition(statement.condition), body, _left(flag))
                return _leavable(flag, _node("KeepRunningUntilFailure", turn))
            case tree.Forever():
                element = _node("KeepRunningUntilFailure", body)
            case tree.Repeat():
                times, before = self._given("repeat", "times", statement.times)
                element = _node("Repeat", body, num_cycles=times)
            case tree.For():
                numbers = counted(statement)
                if numbers is None:
                    raise ScriptError("a loop of a behaviour tree counts from number to number, and has no lists")
                queue = ";".join(number(one) for one in numbers)
                element = _node("LoopDouble", body, queue=queue, value=f"{{{statement.variable}}}")
        element = _leavable(flag, element) if leaves else element
        needed = [statement.times] if isinstance(statement, tree.Repeat) else []
        return self._reading(needed, element, *before)

    def _wait_until(self, statement: tree.WaitUntil, path: str) -> _Element:
        poll = _node("Delay", self._condition(statement.condition), delay_msec=str(_POLL))
        element = _node("RetryUntilSuccessful", poll, num_attempts="-1")
        if statement.seconds is not None:
            element = _node("Timeout", element, msec=_milliseconds(statement.seconds))
        if statement.otherwise is None:
            return element
        return _node("Fallback", element, self._body(statement.otherwise, f"{path}/otherwise"))

    def _on_event(self, statement: tree.OnEvent, path: str) -> _Element:
        if not statement.end:
            raise ScriptError("`whenever` has no node; `as soon as` has")
        flag = f"{OWN}event_{next(self._numbers)}"
        happens = _node("Sequence", self._condition(statement.condition), _flag(flag, "true"))
        watched = _node("ReactiveFallback", happens, self._body(statement.body, f"{path}/body"))
        then = self._body(statement.then, f"{path}/then")
        after = _node("IfThenElse", _node("ScriptCondition", code=flag), then, _node("AlwaysSuccess"))
        return _node("Sequence", _flag(flag, "false"), watched, after)

    def _models(self) -> _Element:
        models = _node("TreeNodesModel")
        for capability, done in sorted(self._used.values(), key=lambda one: one[0].name):
            model = _node("Action", ID=capability.name)
            for parameter in capability.parameters:
                model.append(_model_port("input_port" if done else "output_port", parameter))
                if parameter.type == "list" and not done:
                    text = f"how many there are: {parameter.label}"
                    model.append(_described("output_port", f"{COUNT}{parameter.name}", "int", text))
            if done and takes_place(capability, AT):
                model.append(
                    _described("input_port", AT, "std::string", "a place as x;y, x;y;heading or x;y;z;heading")
                )
            if done:
                model.append(_described("input_port", DURATION, "double", "how long a movement takes, in s"))
            models.append(model)
        if self._logs:
            log = _node("Action", ID="Log")
            log.append(_described("input_port", "message", "std::string", "text to log"))
            log.append(_described("input_port", "value", "BT::AnyTypeAllowed", "a value to log after the text"))
            log.append(_described("input_port", "unit", "std::string", "the unit of the value"))
            models.append(log)
        return models


def _read_by(expression: tree.Expression) -> Iterator[tuple[str, str]]:
    match expression:
        case tree.Read(capability=capability, parameter=parameter):
            yield capability, parameter
        case tree.Unary(operator="count", of=tree.Read(capability=capability, parameter=parameter)):
            yield capability, f"{COUNT}{parameter}"
        case tree.Unary(of=of):
            yield from _read_by(of)
        case tree.Binary(left=left, right=right):
            yield from (*_read_by(left), *_read_by(right))


def _model_port(tag: str, parameter: Parameter) -> _Element:
    unit = f", in {parameter.unit}" if parameter.unit else ""
    element = _described(tag, port(parameter.name), _TYPES[parameter.type], f"{parameter.label}{unit}")
    if parameter.default is not None and tag == "input_port":
        default = parameter.default
        texts = {True: "true", False: "false"}
        element.set("default", texts[default] if isinstance(default, bool) else str(default))
    return element


def _described(tag: str, name: str, kind: str, text: str) -> _Element:
    element = _node(tag, name=name, type=kind)
    element.text = text
    return element


def _place(place: tree.Position) -> str:
    """Return a place as a port value; ScriptError for a computed one."""
    parts = place.parts()
    names = ("x", "y", "z", "heading") if "z" in parts else ("x", "y", "heading")
    components = []
    for name in names:
        part = parts.get(name)
        always = constant(part)
        if part is not None and always is None:
            raise ScriptError("a place of a behaviour tree is written in numbers, not computed")
        components.append("" if always is None else number(always.value))
    return ";".join(components).rstrip(";") if "z" not in parts else ";".join(components)
