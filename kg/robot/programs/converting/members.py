"""The methods of a node that reach capabilities: publishers, subscribers and clients with what uses them."""

from __future__ import annotations

import keyword
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.driving.paths import Field, parse, type_at
from kg.robot.driving.ways import choose
from kg.robot.messages import Types
from kg.robot.programs.converting.fields import Reading, setting
from kg.robot.programs.converting.names import Names, plain, snake
from kg.robot.programs.tokens import quoted
from kg.robot.programs.units import unit_of

if TYPE_CHECKING:
    from kg.robot.capability import Capability, Parameter, Way
    from kg.robot.driving.paths import Path
    from kg.robot.messages import Field as FieldOfMessage
    from kg.robot.programs.converting.dialects import Dialect

__all__ = ["Members", "indented"]

_TYPES: Final = {"number": "float", "integer": "int", "boolean": "bool", "text": "str", "list": "list"}
_READ: Final = {"integer": "float"}
"""The types of what is read where they are others: a whole number that a message does not tell is NaN."""
_GIVEN: Final = {"topic": "", "service": "_Request", "action": "_Goal"}
"""What stands behind the type of a way in the name of the message that is sent."""


def indented(lines: list[str], by: int = 1) -> list[str]:
    """Return lines that stand further to the right."""
    return [f"{'    ' * by}{line}" if line else "" for line in lines]


_ARGUMENTS: Final = frozenset({"self", "seconds", "within", "message", "request", "goal", "end", "math"})


@dataclass
class Members:
    """What a node needs for the capabilities that were asked for so far.

    `made` are statements of the constructor, `connect` and `halt` of the methods of these names, `methods` whole ones.
    """

    dialect: Dialect
    names: Names
    made: list[str] = field(default_factory=list)
    connect: list[str] = field(default_factory=list)
    halt: list[str] = field(default_factory=list)
    methods: list[str] = field(default_factory=list)
    classes: set[tuple[str, str]] = field(default_factory=set)
    helpers: set[str] = field(default_factory=set)
    goals: bool = False
    topics: bool = False
    _known: dict[str, Any] = field(default_factory=dict)
    _types: Types = field(init=False)

    def __post_init__(self) -> None:
        """Take the types of messages of the version of ROS that the code is for."""
        self._types = Types(self.dialect.ros)

    def read(self, capability: Capability, parameter: Parameter) -> str:
        """Return the call that reads a parameter; its method is made when it is asked for first."""
        key = f"{capability.name} {parameter.name}"
        name = self.names.of("read", key, f"{snake(capability.name)}_{snake(parameter.name)}")
        if key not in self._known:
            self._known[key] = name
            self._reader(name, capability, parameter)
        return f"self.{name}()"

    def _reader(self, name: str, capability: Capability, parameter: Parameter) -> None:
        ways = [way for way in capability.ways if way.kind != "action" and parameter.name in way.fields]
        if not ways:
            raise RobotError("KG839", f"no topic or service reports `{parameter.name}`")
        way = choose(ways, (), None, reads=True)
        reading = Reading(way.type)
        expression = reading.of(parse(way.fields[parameter.name]))
        unit = unit_of(parameter.unit)
        if unit.factor != 1:
            expression = f"{expression} * {unit.factor!r}"
        self.helpers |= reading.helpers
        source = self._newest(way) if way.kind == "topic" else self._asked(way)
        shown = f" in {parameter.unit}" if parameter.unit and unit.factor == 1 else ""
        self.methods += [
            f"def {name}(self) -> {_READ.get(parameter.type, _TYPES[parameter.type])}:",
            f'    """Return the {plain(parameter.label)}{shown}."""',
            f"    message = self.{source}()",
            *indented(reading.lines),
            f"    return {expression}",
            "",
        ]

    def _newest(self, way: Way) -> str:
        """Return the method that gives the newest message of a topic."""
        key = f"newest {way.name}"
        if key not in self._known:
            held = self.names.of("message", way.name)
            callback = self.names.of("callback", way.name, f"on_{snake(way.name)}")
            self._known[key] = self.names.of("newest", way.name, f"newest_{snake(way.name)}")
            kind = way.type.rpartition("/")[2]
            self.topics = True
            self.classes.update(self.dialect.types(way, read=True))
            self.made += [f"self.{held}: {kind} | None = None", *self.dialect.subscriber(callback, way)]
            self.methods += [
                f"def {callback}(self, message: {kind}) -> None:",
                f'    """Keep the newest message of {way.name}."""',
                f"    self.{held} = message",
                "",
                f"def {self._known[key]}(self) -> {kind}:",
                f'    """Return the newest message of {way.name}; wait for the first."""',
                f"    self.until(lambda: self.{held} is not None)",
                f"    return self.{held}",
                "",
            ]
        return str(self._known[key])

    def _asked(self, way: Way) -> str:
        """Return the method that gives what a service answers."""
        key = f"ask {way.name}"
        if key not in self._known:
            client = self._client(way)
            self._known[key] = self.names.of("ask", way.name, f"ask_{snake(way.name)}")
            self.methods += [
                f"def {self._known[key]}(self) -> Any:",
                f'    """Return what {way.name} answers."""',
                f"    request = {self.dialect.request(way)}",
                *indented(self.dialect.call(client)),
                "    return response",
                "",
            ]
        return str(self._known[key])

    @staticmethod
    def argument(name: str) -> str:
        """Return the name of the argument for a parameter."""
        made = snake(name)
        return f"{made}_" if keyword.iskeyword(made) or made in _ARGUMENTS else made

    def do(self, capability: Capability, given: tuple[str, ...]) -> tuple[str, str]:
        """Return the method that does something with these parameters, and how: `move`, `once` or `reach`."""
        if not capability.ways:
            raise RobotError("KG839", f"no way to `{capability.label}`", hint=None)
        way = choose(list(capability.ways), given, None, reads=False)
        key = f"do {capability.name}"
        how = "reach" if way.kind == "action" else "move" if way.kind == "topic" and way.rate > 0 else "once"
        if key not in self._known:
            self._known[key] = self.names.of("do", key, capability.label)
            self._doer(str(self._known[key]), capability, way, given, how)
        return str(self._known[key]), how

    def _doer(self, name: str, capability: Capability, way: Way, given: tuple[str, ...], how: str) -> None:
        dialect, label = self.dialect, plain(capability.label)
        root = {"topic": "message", "service": "request", "action": "goal"}[way.kind]
        known = {parameter.name: parameter for parameter in capability.parameters}
        arguments = ["self", *(["seconds: float"] if how == "move" else [])]
        named = [self._declared(known[one]) for one in given]
        named += ["within: float = math.inf"] if how == "reach" else []
        arguments += ["*", *named] if named else []
        made = _class(way) if way.kind == "topic" else dialect.request(way).removesuffix("()")
        body = [f"{root} = {made}()", *self._fields(capability, way, given, root)]
        if how == "move":
            body += self._moving(way, made)
        elif how == "reach":
            self.goals = True
            body += dialect.reach(self._client(way), label)
        elif way.kind == "service":
            body += self._called(way, label)
        else:
            body += [f"self.{self._publisher(way)}.publish(message)"]
        docstring = f'"""Make the robot {label}{" for some seconds" if how == "move" else ""}."""'
        head = f"def {name}({', '.join(arguments)}) -> None:"
        if how == "reach" and given == ():
            head = f"def {name}(self, *, within: float = math.inf) -> None:"
        self.methods += [head, *indented([docstring, *body]), ""]

    def _declared(self, parameter: Parameter) -> str:
        """Return a parameter as the argument of a method."""
        declared = f"{self.argument(parameter.name)}: {_TYPES[parameter.type]}"
        return declared if parameter.default is None else f"{declared} = {_default(parameter)}"

    def _fields(self, capability: Capability, way: Way, given: tuple[str, ...], root: str) -> list[str]:
        """Return the statements that fill a message."""
        lines = []
        if way.kind == "topic" and any(one.type == "std_msgs/Header" for one in self._told(way.type)[:1]):
            lines.append(self.dialect.stamp(f"{root}.header.stamp"))
        for place, value in way.constants.items():
            lines += setting(parse(place), _literal(value), root)
        for parameter in capability.parameters:
            if parameter.name not in way.fields:
                continue
            path = parse(way.fields[parameter.name])
            if parameter.name in given:
                lines += setting(path, self._fitting(path, way, parameter), root)
            elif parameter.default or way.fields[parameter.name].startswith("yaw("):
                lines += setting(path, _default(parameter), root)
        return lines

    def _fitting(self, path: Path, way: Way, parameter: Parameter) -> str:
        """Return an argument as its field takes it: whole numbers and real ones are two things in messages."""
        name = self.argument(parameter.name)
        if parameter.type != "number" or not isinstance(path, Field):
            return name
        sent = way.type + _GIVEN[way.kind]
        kind = type_at(path, self._types, sent) if self._types.knows(sent) else None
        return f"round({name})" if kind is not None and "int" in kind else self.dialect.real(name)

    def _told(self, message: str) -> tuple[FieldOfMessage, ...]:
        """Return the fields of a message, none where its type is not known."""
        return self._types.fields(message) if self._types.knows(message) else ()

    def _moving(self, way: Way, made: str) -> list[str]:
        publisher = self._publisher(way)
        halt = f"self.{publisher}.publish({made}())"
        if halt not in self.halt:
            self.halt.append(halt)
        return [
            "end = self.now() + seconds",
            "try:",
            "    while self.now() < end:",
            f"        self.{publisher}.publish(message)",
            f"        self.sleep(min({1 / way.rate:.6g}, end - self.now()))",
            "finally:",
            f"    {halt}",
        ]

    def _called(self, way: Way, label: str) -> list[str]:
        body = self.dialect.call(self._client(way))
        response = [one.name for one in self._told(f"{way.type}_Response")]
        if "success" not in response:
            return [line.replace("response = self.", "self.") for line in body if line != "response = answer.result()"]
        return [*body, "if not response.success:", f'    raise RuntimeError("could not {label}")']

    def _publisher(self, way: Way) -> str:
        key = f"publisher {way.name}"
        if key not in self._known:
            self._known[key] = self.names.of("publisher", way.name)
            self.classes.update(self.dialect.types(way, read=False))
            self.made += self.dialect.publisher(str(self._known[key]), way)
            self.connect += self.dialect.connect(str(self._known[key]), way)
        return str(self._known[key])

    def _client(self, way: Way) -> str:
        key = f"client {way.name}"
        if key not in self._known:
            self._known[key] = self.names.of("client", way.name)
            self.classes.update(self.dialect.types(way, read=False))
            self.made += self.dialect.client(str(self._known[key]), way)
            self.connect += self.dialect.connect(str(self._known[key]), way)
        return str(self._known[key])


def _default(parameter: Parameter) -> str:
    """Return the default of a parameter as Python, a real number with its point."""
    real = parameter.type == "number" and isinstance(parameter.default, int | float)
    return repr(float(parameter.default or 0)) if real else _literal(parameter.default or 0.0)


def _literal(value: object) -> str:
    return quoted(value) if isinstance(value, str) else repr(value)


def _class(way: Way) -> str:
    return way.type.rpartition("/")[2]
