"""Paths to fields of messages as Python: what reads them, and what sets them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.robot.driving.paths import Call, Each, Element, Field

if TYPE_CHECKING:
    from kg.robot.driving.paths import Argument, Path

__all__ = ["HELPERS", "Reading", "setting"]

HELPERS: Final = {
    "length": '''def length(vector: Any) -> float:
    """Return how long a vector is."""
    return math.hypot(vector.x, vector.y, vector.z)
''',
    "yaw": '''def yaw(turned: Any) -> float:
    """Return the heading of a quaternion in rad."""
    return math.atan2(
        2 * (turned.w * turned.z + turned.x * turned.y),
        1 - 2 * (turned.y * turned.y + turned.z * turned.z),
    )
''',
    "pitch": '''def pitch(turned: Any) -> float:
    """Return the pitch of a quaternion in rad."""
    return math.asin(2 * (turned.w * turned.y - turned.z * turned.x))
''',
    "roll": '''def roll(turned: Any) -> float:
    """Return the roll of a quaternion in rad."""
    return math.atan2(
        2 * (turned.w * turned.x + turned.y * turned.z),
        1 - 2 * (turned.x * turned.x + turned.y * turned.y),
    )
''',
    "valid": '''def valid(scan: Any, ranges: Any) -> list[float]:
    """Return the readings of a scan that count; +inf is free (REP 117)."""
    return [one for one in ranges if scan.range_min <= one <= scan.range_max or one == math.inf]
''',
    "reading": '''def reading(scan: Any, angle: float, width: float = 0.0) -> float:
    """Return what a scan reads at an angle, the nearest within a width; both in rad."""
    step = scan.angle_increment
    middle = round((angle - scan.angle_min) / step) % max(round(math.tau / abs(step)), 1)
    if middle >= len(scan.ranges):
        middle -= round(math.tau / abs(step))
    beams = round(width / 2 / abs(step))
    first = max(middle - beams, 0)
    return min(valid(scan, scan.ranges[first : middle + beams + 1]), default=math.nan)
''',
}
"""Functions that code may need, in the order in which they stand there."""
_NEEDS: Final = {"reading": ("valid",)}
_SCAN: Final = "LaserScan"


@dataclass
class Reading:
    """Makes the expression that reads a path; `lines` come before it, `helpers` are the functions that it needs."""

    kind: str
    lines: list[str] = field(default_factory=list)
    helpers: set[str] = field(default_factory=set)

    def of(self, path: Argument, root: str = "message") -> str:
        """Return the expression for a path in the message `root`; RobotError KG839 for what code is not made for."""
        match path:
            case float():
                return repr(path)
            case Field(None, name):
                return f"{root}.{name}"
            case Each(of):
                return f"list({self.of(of, root)})"
            case Element(of, index):
                return self._sure(f"{self.of(of, root)}[{index}]", f"len({self.of(of, root)}) > {abs(index)}")
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

    def _sure(self, expression: str, condition: str) -> str:
        return f"({expression} if {condition} else math.nan)"

    def _need(self, helper: str) -> None:
        self.helpers |= {helper, *_NEEDS.get(helper, ())}

    def _call(self, call: Call, root: str) -> str:
        first, *rest = call.arguments
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
                return self._most(call.function[:3], first, root)
            case "at":
                self._need("reading")
                return f"reading({root}, {', '.join(self.of(one, root) for one in rest)})"
            case "nearest":
                self._need("length")
                distance = f"length({self.of(rest[0], 'one')})"
                return f"min({self.of(first, root)}, key=lambda one: {distance}, default=None)"
            case "scaled":
                return f"{self.of(first, root)} * {self.of(rest[0], root)}"
        raise RobotError("KG839", f"no code is made for `{call}`")

    def _most(self, function: str, of: Argument, root: str) -> str:
        found = self.of(of, root)
        if self.kind.endswith(_SCAN):
            self._need("valid")
            found = f"valid({root}, {found})"
        return f"{function}({found}, default=math.nan)"


def _element(path: Path) -> tuple[str, Path] | None:
    """Return how a field of each element is read of `one`, and the list; None where the path has no `[]`."""
    match path:
        case Each(of):
            return "one", of
        case Field(of, name) if of is not None:
            inner = _element(of)
            return None if inner is None else (f"{inner[0]}.{name}", inner[1])
        case _:
            return None


def setting(path: Path, value: str, root: str = "message") -> list[str]:
    """Return the statements that set a field; RobotError KG839 for what code is not made for."""
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
