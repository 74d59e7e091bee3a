"""Paths to fields of messages: `linear.x`, `markers[].id`, `yaw(pose.pose.orientation)`, `first(markers).id`.

    path  = ( name | call ) { "." name | "[]" | "[" index "]" }
    call  = function "(" argument { "," argument } ")"
    argument = path | number

`[]` takes what follows of each element of a list. Numbers are written as in Python.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.errors import RobotError
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import Value
    from kg.robot.messages import Types


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message, or of the result of another path."""

    of: Path | None
    name: str

    def __str__(self) -> str:
        return self.name if self.of is None else f"{self.of}.{self.name}"


@dataclass(frozen=True, slots=True)
class Each:
    """The elements of a list; the rest of the path applies to each."""

    of: Path

    def __str__(self) -> str:
        return f"{self.of}[]"


@dataclass(frozen=True, slots=True)
class Element:
    """One element of a list, counted from 0, or from the end if the index is negative."""

    of: Path
    index: int

    def __str__(self) -> str:
        return f"{self.of}[{self.index}]"


@dataclass(frozen=True, slots=True)
class Call:
    """A function of a path, with numbers or more paths as further arguments."""

    function: str
    arguments: tuple[Argument, ...]

    def __str__(self) -> str:
        return f"{self.function}({','.join(str(one) for one in self.arguments)})"


Path: TypeAlias = Field | Each | Element | Call
Argument: TypeAlias = Path | float

_TOKEN: Final = re.compile(
    r"\s*(?:(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>[.,()\[\]]))",
    re.ASCII,
)
_DEEPEST: Final = 16


def parse(text: str) -> Path:
    """Return the path in a text; RobotError KG826 with the place of a syntax error."""
    parser = _Parser(text)
    path = parser.path(0)
    parser.end()
    return path


class _Parser:
    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def path(self, depth: int) -> Path:
        """Parse a path."""
        if depth > _DEEPEST:
            raise self._wrong(f"at most {_DEEPEST} functions in each other")
        name = self._take("name")
        if name is None:
            raise self._wrong("the name of a field or function")
        path: Path = Field(None, name)
        if self._sign("("):
            arguments = [self._argument(depth + 1)]
            while self._sign(","):
                arguments.append(self._argument(depth + 1))
            if not self._sign(")"):
                raise self._wrong("`,` or `)`")
            path = Call(name, tuple(arguments))
        while True:
            if self._sign("."):
                following = self._take("name")
                if following is None:
                    raise self._wrong("the name of a field")
                path = Field(path, following)
            elif self._sign("["):
                path = self._list(path)
            else:
                return path

    def _list(self, path: Path) -> Path:
        index = self._take("number")
        if not self._sign("]"):
            raise self._wrong("`]`")
        if index is None:
            return Each(path)
        if not index.lstrip("+-").isdecimal():
            raise self._wrong("a whole number as an index")
        return Element(path, int(index))

    def _argument(self, depth: int) -> Argument:
        number = self._take("number")
        return self.path(depth) if number is None else float(number)

    def end(self) -> None:
        """Raise RobotError KG826 unless all input is consumed."""
        if self._text[self._at :].strip():
            raise self._wrong("the end")

    def _take(self, group: str) -> str | None:
        match = _TOKEN.match(self._text, self._at)
        if match is None or match[group] is None:
            return None
        self._at = match.end()
        return str(match[group])

    def _sign(self, sign: str) -> bool:
        match = _TOKEN.match(self._text, self._at)
        if match is None or match["sign"] != sign:
            return False
        self._at = match.end()
        return True

    def _wrong(self, expected: str) -> RobotError:
        following = self._text[self._at :].strip()[:20]
        where = f"before `{following}`" if following else "at the end"
        return RobotError("KG826", f"the path `{self._text[:200]}` lacks {expected} {where}")


Look: TypeAlias = "Callable[[Argument, Any], Any]"
"""Returns the value at a path, None if it is missing: used by functions."""

Read: TypeAlias = "Callable[[Look, Any, tuple[Argument, ...]], Any]"
"""Returns the value of a function for its arguments."""


@dataclass(frozen=True, slots=True)
class Function:
    """A function of paths.

    `write` turns the wanted value, and the numeric arguments, into the value of the field; without it the function is
    read-only. `least` and `most` limit the number of arguments.
    """

    read: Read
    least: int = 1
    most: int = 1
    write: Callable[[float, tuple[float, ...]], Any] | None = None


def numbers(value: Any) -> list[float]:
    """Return the numbers in a list of any depth, without NaN."""
    if isinstance(value, list | tuple | bytes):
        return [number for one in value for number in numbers(one)]
    if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
        return []
    return [value]


def _of_one(function: Callable[[Any], Any]) -> Read:
    def read(look: Look, value: Any, arguments: tuple[Argument, ...]) -> Any:
        operand = look(arguments[0], value)
        return None if operand is None else function(operand)

    return read


def _yaw(of: dict[str, float]) -> float:
    x, y, z, w = of["x"], of["y"], of["z"], of["w"]
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def _pitch(of: dict[str, float]) -> float:
    sine = 2 * (of["w"] * of["y"] - of["z"] * of["x"])
    return math.asin(max(-1.0, min(1.0, sine)))


def _roll(of: dict[str, float]) -> float:
    x, y, z, w = of["x"], of["y"], of["z"], of["w"]
    return math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))


def _turned(yaw: float, _: tuple[float, ...]) -> dict[str, float]:
    return {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}


def _distance(of: dict[str, float]) -> float:
    return math.hypot(of["x"], of["y"], of.get("z", 0.0))


def _containing(look: Look, value: Any, path: Argument) -> dict[str, Any]:
    if not isinstance(path, Field):
        return {}
    message = value if path.of is None else look(path.of, value)
    return message if isinstance(message, dict) else {}


def _counts(reading: float, scan: dict[str, Any]) -> bool:
    nearest, farthest = scan.get("range_min", -math.inf), scan.get("range_max") or math.inf
    return reading >= nearest and (reading <= farthest or math.isinf(reading))


def _minimum(look: Look, value: Any, arguments: tuple[Argument, ...]) -> float | None:
    scan = _containing(look, value, arguments[0])
    return min((one for one in numbers(look(arguments[0], value)) if _counts(one, scan)), default=None)


def _at(look: Look, value: Any, arguments: tuple[Argument, ...]) -> float | None:
    ranges, scan = look(arguments[0], value), _containing(look, value, arguments[0])
    angle, width = arguments[1], arguments[2] if len(arguments) > 2 else 0.0  # noqa: PLR2004 - the third of three
    step = scan.get("angle_increment") or 0.0
    if not ranges or not step or not isinstance(angle, float) or not isinstance(width, float):
        return None
    beams = round(width / 2 / abs(step))
    # Scans of a full circle count angles from 0 or from -pi, so the angle may be one turn away.
    turn = round(math.tau / abs(step))
    middle = round((angle - scan.get("angle_min", 0.0)) / step) % max(turn, 1)
    if middle >= len(ranges):
        middle -= turn
    seen = [ranges[index] for index in range(middle - beams, middle + beams + 1) if 0 <= index < len(ranges)]
    return min((one for one in numbers(seen) if _counts(one, scan)), default=None)


def _nearest(look: Look, value: Any, arguments: tuple[Argument, ...]) -> Any:
    elements = look(arguments[0], value) or []
    places = [(look(arguments[1], one), one) for one in elements]
    seen = [(_distance(place), index) for index, (place, _) in enumerate(places) if isinstance(place, dict)]
    return elements[min(seen)[1]] if seen else None


def _scaled(look: Look, value: Any, arguments: tuple[Argument, ...]) -> float | None:
    number = look(arguments[0], value)
    return None if number is None or not isinstance(arguments[1], float) else number * arguments[1]


FUNCTIONS: Final = {
    "yaw": Function(_of_one(_yaw), write=_turned),
    "pitch": Function(_of_one(_pitch)),
    "roll": Function(_of_one(_roll)),
    "distance": Function(_of_one(_distance)),
    "count": Function(_of_one(len)),
    "first": Function(_of_one(lambda found: found[0] if found else None)),
    "minimum": Function(_minimum),
    "maximum": Function(_of_one(lambda found: max(numbers(found), default=None))),
    "at": Function(_at, least=2, most=3),
    "nearest": Function(_nearest, least=2, most=2),
    "scaled": Function(_scaled, least=2, most=2, write=lambda value, factors: value / factors[0]),
}
"""`yaw`, `pitch`, `roll` (rad) of a quaternion; `distance`: the length of a vector; `count`, `first`, `minimum`,
`maximum` of a list; `at(ranges,ANGLE[,WIDTH])`: the range of a scan at an angle, the nearest within a width (rad);
`nearest(list,PATH)`: the element with the shortest vector at PATH; `scaled(path,FACTOR)`. `yaw` and `scaled` can be
written too.
"""


def look(path: Argument, value: Any) -> Any:
    """Return the value at a path; None if it is missing, or NaN."""
    if isinstance(path, float):
        return path
    if isinstance(path, Call):
        try:
            result = _function(path).read(look, value, path.arguments)
        except (TypeError, KeyError, AttributeError, ArithmeticError):
            raise RobotError("KG826", f"`{path}` is of a field of another kind") from None
    elif isinstance(path, Field):
        result = _field(value if path.of is None else look(path.of, value), path.name, many=_many(path.of))
    elif isinstance(path, Each):
        result = _elements(look(path.of, value), many=_many(path.of))
    else:
        result = _element(look(path.of, value), path.index, many=_many(path.of))
    return None if isinstance(result, float) and math.isnan(result) else result


def _many(path: Path | None) -> bool:
    """Return whether the rest of a path applies to each element."""
    if path is None or isinstance(path, Call):
        return False
    return isinstance(path, Each) or _many(path.of)


def _field(of: Any, name: str, *, many: bool) -> Any:
    if many:
        return [_field(one, name, many=False) for one in of or ()]
    return of.get(name) if isinstance(of, dict) else None


def _elements(of: Any, *, many: bool) -> Any:
    if many:
        return [element for one in of or () for element in one or ()]
    return list(of) if isinstance(of, list | tuple | bytes) else []


def _element(of: Any, index: int, *, many: bool) -> Any:
    if many:
        return [_element(one, index, many=False) for one in of or ()]
    return of[index] if isinstance(of, list | tuple | bytes) and -len(of) <= index < len(of) else None


def put(path: Path, message: Value, value: Any) -> None:
    """Set the value at a path of a message, creating missing parents; RobotError KG826 a read-only path."""
    if isinstance(path, Call):
        write, (target, *others) = _function(path).write, path.arguments
        numbers = tuple(one for one in others if isinstance(one, float))
        if write is None or isinstance(target, float) or len(numbers) != len(others):
            raise RobotError("KG826", f"`{path}` cannot be written")
        put(target, message, write(value, numbers))
    elif isinstance(path, Field):
        _inner(path.of, message, path)[path.name] = value
    else:
        raise RobotError("KG826", f"`{path}` cannot be written")


def _inner(path: Path | None, message: Value, whole: Path) -> Value:
    """Return the message at a path, created if missing; an element of a list is created up to its index."""
    if path is None:
        return message
    if isinstance(path, Element) and isinstance(path.of, Field) and path.index >= 0:
        elements: list[Value] = _inner(path.of.of, message, whole).setdefault(path.of.name, [])
        elements.extend({} for _ in range(path.index + 1 - len(elements)))
        return elements[path.index]
    if not isinstance(path, Field):
        raise RobotError("KG826", f"`{whole}` cannot be written")
    inner: Value = _inner(path.of, message, whole).setdefault(path.name, {})
    return inner


def _function(call: Call) -> Function:
    function = FUNCTIONS.get(call.function)
    if function is None:
        raise RobotError("KG826", f"`{call}`: unknown function", hint=did_you_mean(call.function, FUNCTIONS))
    return function


def roots(path: Argument) -> list[str]:
    """Return the top-level fields that a path reads; a function may read several."""
    if isinstance(path, float):
        return []
    if isinstance(path, Call):
        paths = path.arguments[:1] if path.function == "nearest" else path.arguments
        return [name for one in paths for name in roots(one)]
    return [path.name] if isinstance(path, Field) and path.of is None else roots(path.of or 0.0)


def type_at(path: Argument, types: Types, kind: str, whole: str = "") -> str | None:
    """Return the type at a path of a type, None if it is unknown; `whole` is the path for messages.

    Raises:
        RobotError: KG826 an unknown function, or a field missing from a type; KG804 an unknown type of message.
    """
    whole = whole or str(path)
    if isinstance(path, float):
        return None
    if isinstance(path, Call):
        return _returned(path, types, kind, whole)
    if not isinstance(path, Field):
        return type_at(path.of, types, kind, whole)
    inner = kind if path.of is None else type_at(path.of, types, kind, whole)
    if inner is None:
        return None
    if "/" not in inner:
        raise RobotError("KG826", f"`{whole}`: `{path.of}` has no fields: it is a {inner}")
    fields = {one.name: one for one in types.fields(inner)}
    if path.name not in fields:
        hint = did_you_mean(path.name, fields) or f"Its fields are: {', '.join(fields)}."
        raise RobotError("KG826", f"`{whole}`: {inner} has no field `{path.name}`", hint=hint)
    return fields[path.name].type


def _returned(call: Call, types: Types, kind: str, whole: str) -> str | None:
    function = _function(call)
    if not function.least <= len(call.arguments) <= function.most:
        raise RobotError("KG826", f"`{call}` has {len(call.arguments)} arguments, not {function.least}")
    inner = type_at(call.arguments[0], types, kind, whole)
    if call.function == "nearest" and inner is not None:
        type_at(call.arguments[1], types, inner, whole)
    return inner if call.function in {"first", "nearest"} else None
