"""The functions that may stand before paths, by name: what they are of values, and what they do to a field.

Those that look at a scan (`at`, `minimum`) use the fields beside its list: `angle_min` and `angle_increment` say where
a beam points, `range_min` and `range_max` which readings count (REP 117: +inf is free, NaN is not a reading).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.robot.driving.paths import Field

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.driving.paths import Argument

__all__ = ["FUNCTIONS", "Function", "Look", "Read", "numbers"]

Look: TypeAlias = "Callable[[Argument, Any], Any]"
"""What a path is in a value, None where there is nothing: what functions look with."""

Read: TypeAlias = "Callable[[Look, Any, tuple[Argument, ...]], Any]"
"""What a function is of the arguments written, in a value."""


@dataclass(frozen=True, slots=True)
class Function:
    """A function of the language of paths.

    `write` turns the value that is wanted, and the numbers behind the path, into the value of the field; without it
    the function only reads. `least` and `most` are how many arguments there are.
    """

    read: Read
    least: int = 1
    most: int = 1
    write: Callable[[float, tuple[float, ...]], Any] | None = None


def numbers(value: Any) -> list[float]:
    """Return the numbers in a list of any depth, without those that are NaN."""
    if isinstance(value, list | tuple | bytes):
        return [number for one in value for number in numbers(one)]
    if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
        return []
    return [value]


def _of_one(function: Callable[[Any], Any]) -> Read:
    def read(look: Look, value: Any, arguments: tuple[Argument, ...]) -> Any:
        found = look(arguments[0], value)
        return None if found is None else function(found)

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


def _beside(look: Look, value: Any, path: Argument) -> dict[str, Any]:
    """Return the message that a list is a field of."""
    if not isinstance(path, Field):
        return {}
    found = value if path.of is None else look(path.of, value)
    return found if isinstance(found, dict) else {}


def _counts(reading: float, scan: dict[str, Any]) -> bool:
    nearest, farthest = scan.get("range_min", -math.inf), scan.get("range_max") or math.inf
    return reading >= nearest and (reading <= farthest or math.isinf(reading))


def _minimum(look: Look, value: Any, arguments: tuple[Argument, ...]) -> float | None:
    scan = _beside(look, value, arguments[0])
    return min((one for one in numbers(look(arguments[0], value)) if _counts(one, scan)), default=None)


def _at(look: Look, value: Any, arguments: tuple[Argument, ...]) -> float | None:
    ranges, scan = look(arguments[0], value), _beside(look, value, arguments[0])
    angle, width = arguments[1], arguments[2] if len(arguments) > 2 else 0.0  # noqa: PLR2004 - the third of three
    step = scan.get("angle_increment") or 0.0
    if not ranges or not step or not isinstance(angle, float) or not isinstance(width, float):
        return None
    beams = round(width / 2 / abs(step))
    middle = _beam(angle, scan.get("angle_min", 0.0), step, len(ranges))
    seen = [ranges[index] for index in range(middle - beams, middle + beams + 1) if 0 <= index < len(ranges)]
    return min((one for one in numbers(seen) if _counts(one, scan)), default=None)


def _beam(angle: float, first: float, step: float, count: int) -> int:
    """Return the index of the beam at an angle; scans that go around count angles from 0 or from -pi."""
    turn = round(math.tau / abs(step))
    index = round((angle - first) / step) % max(turn, 1)
    return index if index < count else index - turn


def _nearest(look: Look, value: Any, arguments: tuple[Argument, ...]) -> Any:
    elements = look(arguments[0], value) or []
    places = [(look(arguments[1], one), one) for one in elements]
    seen = [(_distance(place), index) for index, (place, _) in enumerate(places) if isinstance(place, dict)]
    return elements[min(seen)[1]] if seen else None


def _scaled(look: Look, value: Any, arguments: tuple[Argument, ...]) -> float | None:
    found = look(arguments[0], value)
    return None if found is None or not isinstance(arguments[1], float) else found * arguments[1]


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
`maximum` of a list; `at(ranges,ANGLE[,WIDTH])`: what a scan reads at an angle, the nearest within a width (rad);
`nearest(list,PATH)`: the element whose vector at PATH is the shortest; `scaled(path,FACTOR)`. `yaw` and `scaled` can be
written too."""
