"""Methods of a generated node for its capabilities: publishers, subscribers and clients, and their uses.

Paths to message fields become Python expressions.
"""

from __future__ import annotations

import keyword
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.driving.paths import Argument, Call, Each, Element, Field, Path, parse, type_at
from kg.robot.driving.ways import choose
from kg.robot.messages import Field as FieldOfMessage
from kg.robot.messages import Types
from kg.robot.programs.converting.code import COMMON, Dialect, Names, indented, plain, snake
from kg.robot.programs.tokens import quoted
from kg.robot.programs.units import unit_of

if TYPE_CHECKING:
    from kg.robot.capability import Capability, Parameter, Way

_NEEDS: Final = {"reading": ("valid",)}
_SCAN: Final = "LaserScan"


@dataclass
class Reading:
    """Generator of expressions that read a path.

    `lines` precede the expression, `helpers` are the functions it needs.
    """

    kind: str
    lines: list[str] = field(default_factory=list)
    helpers: set[str] = field(default_factory=set)

    def of(self, path: Argument, root: str = "message") -> str:
        """Return the expression for a path in the message `root`; RobotError KG839 if it cannot be generated."""
        match path:
            case float():
                return repr(path)
            case Field(None, name):
                return f"{root}.{name}"
            case Each(of):
                return f"list({self.of(of, root)})"
            case Element(of, index):
                whole = self.of(of, root)
                return f"({whole}[{index}] if len({whole}) > {abs(index)} else math.nan)"
            case Field():
                return self._field(path, root)
            case Call():
                return self._call(path, root)

    def _field(self, path: Field, root: str) -> str:
        each = _element(path)
        if each is not None:
            element, source = each
            return f"[{element} for one in {self.of(source, root)}]"
        base = self.of(path.of or 0.0, root)
        if isinstance(path.of, Call):
            self.lines += [f"found = {base}", "if found is None:", "    return math.nan"]
            base = "found"
        return f"{base}.{path.name}"

    def _need(self, helper: str) -> None:
        self.helpers |= {helper, *_NEEDS.get(helper, ())}

    def _call(self, call: Call, root: str) -> str:
        first, *others = call.arguments
        match call.function:
            case "yaw" | "pitch" | "roll":
                self._need(call.function)
                return f"{call.function}({self.of(first, root)})"
            case "distance":
                self._need("length")
                return f"length({self.of(first, root)})"
            case "count":
                return f"float(len({self.of(first, root)}))"
            case "first":
                return f"next(iter({self.of(first, root)}), None)"
            case "minimum" | "maximum":
                operand = self.of(first, root)
                if self.kind.endswith(_SCAN):
                    self._need("valid")
                    operand = f"valid({root}, {operand})"
                return f"{call.function[:3]}({operand}, default=math.nan)"
            case "at":
                self._need("reading")
                return f"reading({root}, {', '.join(self.of(one, root) for one in others)})"
            case "nearest":
                self._need("length")
                distance = f"length({self.of(others[0], 'one')})"
                return f"min({self.of(first, root)}, key=lambda one: {distance}, default=None)"
            case "scaled":
                return f"{self.of(first, root)} * {self.of(others[0], root)}"
        raise RobotError("KG839", f"no code is made for `{call}`")


def _element(path: Path) -> tuple[str, Path] | None:
    """Return the expression for a field of each element `one`, and the list; None for a path without `[]`."""
    match path:
        case Each(of):
            return "one", of
        case Field(of, name) if of is not None:
            inner = _element(of)
            return None if inner is None else (f"{inner[0]}.{name}", inner[1])
        case _:
            return None


def setting(path: Path, value: str, root: str = "message") -> list[str]:
    """Return the statements that set a field; RobotError KG839 if they cannot be generated."""
    match path:
        case Field():
            return [f"{_target(path, root)} = {value}"]
        case Call("yaw", (Field() as turned,)):
            target = _target(turned, root)
            if value == "0.0":
                return [f"{target}.w = 1.0"]
            return [f"{target}.z = math.sin({value} / 2)", f"{target}.w = math.cos({value} / 2)"]
        case Call("scaled", (Field() as scaled, float(factor))):
            return [f"{_target(scaled, root)} = {value} / {factor!r}"]
    raise RobotError("KG839", f"no code is made that sets `{path}`")


def _target(path: Path, root: str) -> str:
    if not isinstance(path, Field):
        raise RobotError("KG839", f"no code is made that sets `{path}`")
    return f"{root}.{path.name}" if path.of is None else f"{_target(path.of, root)}.{path.name}"


_TYPES: Final = {"number": "float", "integer": "int", "boolean": "bool", "text": "str", "list": "list"}
_READ: Final = {"integer": "float"}
"""Types of values read that differ from their parameter: an integer missing from a message is NaN."""


_ARGUMENTS: Final = frozenset({"self", "seconds", "within", "message", "request", "goal", "end", "math"})


@dataclass
class Members:
    """The members of a node for the capabilities used so far.

    `create` has statements of the constructor, `connect` and `halt` those of the methods of these names, `methods`
    whole methods, and `classes` imports of messages.
    """

    dialect: Dialect
    names: Names
    create: list[str] = field(default_factory=list)
    connect: list[str] = field(default_factory=list)
    halt: list[str] = field(default_factory=list)
    methods: list[str] = field(default_factory=list)
    classes: list[str] = field(default_factory=list)
    helpers: set[str] = field(default_factory=set)
    goals: bool = False
    topics: bool = False
    _names_by_key: dict[str, Any] = field(default_factory=dict)
    _types: Types = field(init=False)

    def __post_init__(self) -> None:
        self._types = Types(self.dialect.ros)

    def read(self, capability: Capability, parameter: Parameter) -> str:
        """Return the call that reads a parameter, and add its method on first use."""
        key = f"{capability.name} {parameter.name}"
        name = self.names.of("read", key, f"{snake(capability.name)}_{snake(parameter.name)}")
        if key not in self._names_by_key:
            self._names_by_key[key] = name
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
        source = self._newest(way) if way.kind == "topic" else self._response(way)
        shown = f" in {parameter.unit}" if parameter.unit and unit.factor == 1 else ""
        self._add(
            "reader",
            name=name,
            kind=_READ.get(parameter.type, _TYPES[parameter.type]),
            label=f"{plain(parameter.label)}{shown}",
            source=source,
            lines="\n".join(["", *indented(reading.lines)]),
            expression=expression,
        )

    def _add(self, piece: str, **words: str) -> None:
        self.methods += [*COMMON.lines(piece, **words), ""]

    def _newest(self, way: Way) -> str:
        key = f"newest {way.name}"
        if key not in self._names_by_key:
            message = self.names.of("message", way.name)
            callback = self.names.of("callback", way.name, f"on_{snake(way.name)}")
            self._names_by_key[key] = self.names.of("newest", way.name, f"newest_{snake(way.name)}")
            kind = way.type.rpartition("/")[2]
            self.topics = True
            self.classes += self.dialect.of_way("classes of", way)
            self.create += [f"self.{message}: {kind} | None = None"]
            self.create += self.dialect.of_way("subscriber", way, attribute=callback)
            newest = str(self._names_by_key[key])
            self._add("newest", callback=callback, kind=kind, topic=way.name, held=message, newest=newest)
        return str(self._names_by_key[key])

    def _response(self, way: Way) -> str:
        key = f"ask {way.name}"
        if key not in self._names_by_key:
            client = self._client(way)
            self._names_by_key[key] = self.names.of("ask", way.name, f"ask_{snake(way.name)}")
            call = indented(self.dialect.lines("call", attribute=client))
            request = "\n".join(self.dialect.of_way("message of", way))
            method = str(self._names_by_key[key])
            self._add("asked", method=method, service=way.name, request=request, call="\n".join(call))
        return str(self._names_by_key[key])

    @staticmethod
    def argument(name: str) -> str:
        """Return the argument name of a parameter."""
        word = snake(name)
        return f"{word}_" if keyword.iskeyword(word) or word in _ARGUMENTS else word

    def do(self, capability: Capability, given: tuple[str, ...]) -> tuple[str, str]:
        """Return the method that executes a capability with these parameters; it is a `move`, `once` or `reach`."""
        if not capability.ways:
            raise RobotError("KG839", f"no way to `{capability.label}`")
        way = choose(list(capability.ways), given, None, reads=False)
        key = f"do {capability.name}"
        how = "reach" if way.kind == "action" else "move" if way.kind == "topic" and way.rate > 0 else "once"
        if key not in self._names_by_key:
            self._names_by_key[key] = self.names.of("do", key, capability.label)
            self._doer(str(self._names_by_key[key]), capability, way, given, how)
        return str(self._names_by_key[key]), how

    def _doer(self, name: str, capability: Capability, way: Way, given: tuple[str, ...], how: str) -> None:
        dialect, label = self.dialect, plain(capability.label)
        root = {"topic": "message", "service": "request", "action": "goal"}[way.kind]
        parameters = {parameter.name: parameter for parameter in capability.parameters}
        arguments = ["self", *(["seconds: float"] if how == "move" else [])]
        named = []
        for parameter in (parameters[one] for one in given):
            default = "" if parameter.default is None else f" = {_default(parameter)}"
            named.append(f"{self.argument(parameter.name)}: {_TYPES[parameter.type]}{default}")
        named += ["within: float = math.inf"] if how == "reach" else []
        arguments += ["*", *named] if named else []
        message = "\n".join(dialect.of_way("message of", way))
        body = [f"{root} = {message}", *self._fields(capability, way, given, root)]
        if how == "move":
            body += self._moving(way, message)
        elif how == "reach":
            self.goals = True
            body += dialect.lines("reach", attribute=self._client(way), label=label)
        elif way.kind == "service":
            body += self._called(way, label)
        else:
            body += [f"self.{self._publisher(way)}.publish(message)"]
        docstring = f'"""Make the robot {label}{" for some seconds" if how == "move" else ""}."""'
        head = f"def {name}({', '.join(arguments)}) -> None:"
        if how == "reach" and given == ():
            head = f"def {name}(self, *, within: float = math.inf) -> None:"
        self.methods += [head, *indented([docstring, *body]), ""]

    def _fields(self, capability: Capability, way: Way, given: tuple[str, ...], root: str) -> list[str]:
        lines = []
        if way.kind == "topic" and any(one.type == "std_msgs/Header" for one in self._fields_of(way.type)[:1]):
            lines += self.dialect.lines("stamp", target=f"{root}.header.stamp")
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
        """Return an argument converted for its field: messages distinguish integers from floats."""
        name = self.argument(parameter.name)
        if parameter.type != "number" or not isinstance(path, Field):
            return name
        kind = type_at(path, self._types, way.sent) if self._types.has(way.sent) else None
        whole = kind is not None and "int" in kind
        return f"round({name})" if whole else self.dialect.text("real number", value=name)

    def _fields_of(self, message: str) -> tuple[FieldOfMessage, ...]:
        """Return the fields of a message; none if its type is unknown."""
        return self._types.fields(message) if self._types.has(message) else ()

    def _moving(self, way: Way, message: str) -> list[str]:
        publisher = self._publisher(way)
        halt = f"self.{publisher}.publish({message})"
        if halt not in self.halt:
            self.halt.append(halt)
        return COMMON.lines("moving", publisher=publisher, period=f"{1 / way.rate:.6g}", halt=halt)

    def _called(self, way: Way, label: str) -> list[str]:
        client = self._client(way)
        if "success" not in [one.name for one in self._fields_of(f"{way.type}_Response")]:
            return self.dialect.lines("call without response", attribute=client)
        body = self.dialect.lines("call", attribute=client)
        return [*body, "if not response.success:", f'    raise RuntimeError("could not {label}")']

    def _publisher(self, way: Way) -> str:
        return self._end(way, "publisher", "publisher")

    def _client(self, way: Way) -> str:
        return self._end(way, "client", "client of")

    def _end(self, way: Way, kind: str, piece: str) -> str:
        """Return the attribute of the publisher or client of an interface, and create it on first use."""
        key = f"{kind} {way.name}"
        if key not in self._names_by_key:
            attribute = self._names_by_key[key] = self.names.of(kind, way.name)
            self.classes += self.dialect.of_way("classes of", way)
            self.create += self.dialect.of_way(piece, way, attribute=attribute)
            self.connect += self.dialect.of_way("connect to", way, attribute=attribute)
        return str(self._names_by_key[key])


def _default(parameter: Parameter) -> str:
    """Return the default of a parameter as Python; a float keeps its decimal point."""
    real = parameter.type == "number" and isinstance(parameter.default, int | float)
    return repr(float(parameter.default or 0)) if real else _literal(parameter.default or 0.0)


def _literal(value: object) -> str:
    return quoted(value) if isinstance(value, str) else repr(value)
