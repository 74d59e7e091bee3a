"""The view of a world from above, as SVG: rooms with names, walls, objects, tags, the robot and its trail."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.arm import Arm
from kg.robot.simulation.drone import Drone
from kg.robot.simulation.wheeled import RADIUS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.simulation.plan import Plan, Thing
    from kg.robot.simulation.world import World

_ACROSS: Final = 600  # width of the picture in units: letters have sizes that all viewers draw

_MARGIN: Final = 15  # margin around the world in units
_BELOW: Final = 28  # space below the world for the caption in units
_NAME: Final = 0.76  # relative height of a room's name, above the tag on a pad

_BASE: Final = 0.08
_HAND: Final = 0.03  # sizes of the base and the hand of an arm in metres
_SHOWN: Final = 400  # number of drawn points of the trail: 40 m

_STYLE: Final = """
.floor{fill:#fbfaf7}.wall{stroke:#57534e;stroke-width:5;stroke-linecap:square}.room{fill:none;stroke:#d6d3d1;
stroke-dasharray:4 4}.name{fill:#57534e;font:20px sans-serif;text-anchor:middle}.thing{stroke:#78716c}
.tag{fill:#111;stroke:#fff}.number{fill:#fff;font:bold 16px sans-serif;text-anchor:middle}
.trail{fill:none;stroke:#2563eb;stroke-width:2;opacity:.6}.robot{fill:#2563eb;stroke:#fff;stroke-width:2}
.ahead{stroke:#fff;stroke-width:3;stroke-linecap:round}.state{fill:#1c1917;font:19px sans-serif}
@media(prefers-color-scheme:dark){.floor{fill:#1c1b1a}.wall{stroke:#a8a29e}.room{stroke:#44403c}.name{fill:#d6d3d1}
.thing{opacity:.7}.tag{stroke:#d6d3d1}.trail,.ahead{stroke:#93c5fd}.robot{fill:#3b82f6}.state{fill:#e7e5e4}}
"""


class TopView:
    """Draws a world; static parts are drawn once."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._plan = world.plan
        self._scale = round(_ACROSS / world.plan.width)
        self._still = "".join(self._drawn(world.plan))

    def svg(self) -> str:
        """Return the current picture, an SVG document of some kilobytes."""
        places = ((one, self._world.thing_at(one.name)) for one in self._plan.things if one.mass)
        moved = "".join(self._thing(one, x, y) for one, (x, y, _) in places)
        points = " ".join(f"{self._x(x)},{self._y(y)}" for x, y in self._world.trail.points[-_SHOWN:])
        trail = f'<polyline class="trail" points="{points}"/>'
        return f"{self._still}{moved}{trail}{self._robot()}{self._state()}</svg>"

    def _x(self, x: float) -> str:
        return f"{x * self._scale + _MARGIN:.0f}"

    def _y(self, y: float) -> str:
        return f"{(self._plan.depth - y) * self._scale + _MARGIN:.0f}"

    def _drawn(self, plan: Plan) -> Iterator[str]:
        width = round(plan.width * self._scale) + 2 * _MARGIN
        height = round(plan.depth * self._scale) + 2 * _MARGIN + _BELOW
        margin = _MARGIN / self._scale
        scale = f'data-left="{-margin}" data-top="{plan.depth + margin}" data-scale="{self._scale}"'
        yield f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" {scale} role="img">'
        yield f"<title>The {plan.name} from above</title><style>{_STYLE}</style>"
        yield f'<rect class="floor" width="{width}" height="{height}"/>'
        for room in plan.rooms:
            size = f'width="{room.width * self._scale:.0f}" height="{room.depth * self._scale:.0f}"'
            yield f'<rect class="room" x="{self._x(room.x)}" y="{self._y(room.y + room.depth)}" {size}/>'
            middle = f'x="{self._x(room.x + room.width / 2)}" y="{self._y(room.y + _NAME * room.depth)}"'
            yield f'<text class="name" {middle}>{escape(room.name)}</text>'
        yield from (self._thing(one, one.x, one.y) for one in plan.things if not one.mass)
        for wall in plan.walls:
            for x, y, to_x, to_y in wall.pieces():
                ends = f'x1="{self._x(x)}" y1="{self._y(y)}" x2="{self._x(to_x)}" y2="{self._y(to_y)}"'
                yield f'<line class="wall" {ends}/>'
        for tag in plan.tags:
            x, y = tag.x * self._scale + _MARGIN, (plan.depth - tag.y) * self._scale + _MARGIN
            yield f'<rect class="tag" x="{x - 12:.0f}" y="{y - 11:.0f}" width="24" height="22" rx="2"/>'
            yield f'<text class="number" x="{x:.0f}" y="{y + 6:.0f}">{tag.id}</text>'

    def _thing(self, thing: Thing, x: float, y: float) -> str:
        look = f'class="thing" fill="{thing.color}"><title>{escape(thing.name)}</title>'
        if thing.shape == "cylinder":
            at = f'cx="{self._x(x)}" cy="{self._y(y)}" r="{thing.radius * self._scale:.0f}"'
            return f"<circle {at} {look}</circle>"
        at = f'x="{self._x(x - thing.width / 2)}" y="{self._y(y + thing.depth / 2)}"'
        return (
            f'<rect {at} width="{thing.width * self._scale:.0f}" height="{thing.depth * self._scale:.0f}" {look}</rect>'
        )

    def _robot(self) -> str:
        pose, length = self._world.robot.pose, RADIUS * 1.4
        if isinstance(self._world.robot, Arm):
            return self._arm(self._world.robot)
        ends = (pose.x + length * math.cos(pose.heading), pose.y + length * math.sin(pose.heading))
        at = f'cx="{self._x(pose.x)}" cy="{self._y(pose.y)}" r="{RADIUS * 1.4 * self._scale:.0f}"'
        line = f'x1="{self._x(pose.x)}" y1="{self._y(pose.y)}" x2="{self._x(ends[0])}" y2="{self._y(ends[1])}"'
        return f'<circle class="robot" {at}/><line class="ahead" {line}/>'

    def _arm(self, arm: Arm) -> str:
        base = f'cx="{self._x(arm.base.x)}" cy="{self._y(arm.base.y)}" r="{_BASE * self._scale:.0f}"'
        hand = f'cx="{self._x(arm.pose.x)}" cy="{self._y(arm.pose.y)}" r="{_HAND * self._scale:.0f}"'
        ends = f'x1="{self._x(arm.base.x)}" y1="{self._y(arm.base.y)}" x2="{self._x(arm.pose.x)}"'
        line = f'{ends} y2="{self._y(arm.pose.y)}"'
        return f'<line class="trail" {line}/><circle class="robot" {base}/><circle class="robot" {hand}/>'

    def _state(self) -> str:
        robot = self._world.robot
        room = self._plan.room_at(robot.pose.x, robot.pose.y)
        parts = [f"{self._world.time:.1f} s", *([room] if room else [])]
        if isinstance(robot, Arm):
            parts += [f"hand at {robot.pose.z:.2f} m", f"gripper open by {100 * robot.opening:.0f} cm"]
        else:
            parts.insert(1, f"battery {robot.battery.charge:.0%}")
        if isinstance(robot, Drone):
            parts += [robot.state.name.lower().replace("_", " "), f"altitude {robot.altitude:.1f} m"]
        below = f"{self._plan.depth * self._scale + 2 * _MARGIN + _BELOW - 8:.0f}"
        return f'<text class="state" x="10" y="{below}">{escape(" · ".join(parts))}</text>'
