"""The navigation node, which executes goals like `move_base` of ROS 1 and the navigator of Nav2.

Paths are found by A* on the grid of a plan, away from walls, then straightened. The velocity follows from the pose and
the laser.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.robot.simulation.robots import Command, Pose, heading_of, wrapped
from kg.robot.simulation.stage import Node, point, posed
from kg.robot.simulation.wheeled import RADIUS, SPEED, Wheeled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.robot.connection import Accepted, Publication, Value
    from kg.robot.simulation.plan import Plan

Cell = tuple[int, int]
"""Row and column: to the north and to the east."""

_MARGIN: Final = 0.1
_HALF_WALL: Final = 0.05


class Grid:
    """The map of a plan as a grid with cells of `resolution` metres, with a border.

    `taken` marks occupied cells; `origin` is the corner of the first cell, in both directions.
    """

    def __init__(self, plan: Plan, resolution: float) -> None:
        self.resolution = resolution
        self.origin = -_MARGIN
        self.rows = math.ceil((plan.depth + 2 * _MARGIN) / resolution)
        self.columns = math.ceil((plan.width + 2 * _MARGIN) / resolution)
        self._north, self._east = np.indices((self.rows, self.columns)) * resolution + self.origin + resolution / 2
        self.taken: np.ndarray[Any, Any] = np.zeros((self.rows, self.columns), dtype=bool)
        self._draw(plan)

    def _draw(self, plan: Plan) -> None:
        for wall in plan.walls:
            for x, y, to_x, to_y in wall.pieces():
                self._box(
                    (x + to_x) / 2, (y + to_y) / 2, abs(to_x - x) / 2 + _HALF_WALL, abs(to_y - y) / 2 + _HALF_WALL
                )
        for thing in plan.things:
            if thing.shape == "box":
                self._box(thing.x, thing.y, thing.width / 2, thing.depth / 2)
            else:
                self.taken |= np.hypot(self._east - thing.x, self._north - thing.y) <= thing.radius

    def _box(self, x: float, y: float, half_width: float, half_depth: float) -> None:
        slack = 1e-9
        self.taken |= (abs(self._east - x) <= half_width + slack) & (abs(self._north - y) <= half_depth + slack)

    def cell(self, x: float, y: float) -> Cell:
        """Return the cell of a point; it may be outside of the grid."""
        return math.floor((y - self.origin) / self.resolution), math.floor((x - self.origin) / self.resolution)

    def point(self, cell: Cell) -> tuple[float, float]:
        """Return the centre of a cell, as x and y."""
        row, column = cell
        return (
            self.origin + (column + 0.5) * self.resolution,
            self.origin + (row + 0.5) * self.resolution,
        )

    def near(self, distance: float) -> np.ndarray[Any, Any]:
        """Return true for the cells within a distance in metres of an obstacle."""
        reach = int(distance / self.resolution)
        padded = np.pad(self.taken, reach, constant_values=True)
        near = np.zeros_like(self.taken)
        for down in range(-reach, reach + 1):
            for right in range(-reach, reach + 1):
                if math.hypot(down, right) * self.resolution <= distance:
                    rows = slice(reach + down, reach + down + self.rows)
                    near |= padded[rows, reach + right : reach + right + self.columns]
        return near

    def occupancy(self) -> list[int]:
        """Return the data of a `nav_msgs/OccupancyGrid`: 100 for occupied, 0 for free, row by row."""
        return [int(one) for one in np.where(self.taken, 100, 0).flatten()]


_RESOLUTION: Final = 0.1
_PREFERRED: Final = 0.2  # preferred distance of a path from obstacles, in metres
_DETOUR: Final = 3.0  # cost factor of cells near walls: paths prefer the middle

_STEPS: Final = [(down, right) for down in (-1, 0, 1) for right in (-1, 0, 1) if down or right]


class Planner:
    """Path planner for a round robot.

    Args:
        plan: the world.
        radius: of the robot, in metres.
    """

    def __init__(self, plan: Plan, radius: float) -> None:
        self._grid = Grid(plan, _RESOLUTION)
        self._blocked = self._grid.near(radius + 0.02)
        self._close = self._grid.near(radius + _PREFERRED)

    def way(self, start: tuple[float, float], goal: tuple[float, float]) -> list[tuple[float, float]] | None:
        """Return the points of the path to a goal without the start; None if it is unreachable."""
        end = self._grid.cell(*goal) if math.isfinite(sum(goal)) else (-1, -1)
        if not self._free(end):
            return None
        row, column = self._grid.cell(*start)
        around = range(-4, 5)
        near = sorted((math.hypot(down, right), down, right) for down in around for right in around)
        cells = ((row + down, column + right) for _, down, right in near)
        begin = next((cell for cell in cells if self._free(cell)), None)
        path = self._search(begin, end) if begin else None
        return None if path is None else [*self._straightened(path)[1:-1], goal]

    def _free(self, cell: Cell) -> bool:
        row, column = cell
        return 0 <= row < self._grid.rows and 0 <= column < self._grid.columns and not self._blocked[row, column]

    def _search(self, start: Cell, goal: Cell) -> list[Cell] | None:
        cost = {start: 0.0}
        before: dict[Cell, Cell] = {}
        waiting = [(math.dist(start, goal), start)]
        while waiting:
            _, cell = heapq.heappop(waiting)
            if cell == goal:
                path = [goal]
                while path[-1] in before:
                    path.append(before[path[-1]])
                return path[::-1]
            for down, right in _STEPS:
                there = cell[0] + down, cell[1] + right
                if not self._free(there):
                    continue
                now = cost[cell] + math.hypot(down, right) * (_DETOUR if self._close[there] else 1.0)
                if now < cost.get(there, math.inf):
                    cost[there], before[there] = now, cell
                    heapq.heappush(waiting, (now + math.dist(there, goal), there))
        return None

    def _straightened(self, cells: list[Cell]) -> list[tuple[float, float]]:
        corners = [cells[0]]
        for last, cell in pairwise(cells):
            if not self._clear(corners[-1], cell):
                corners.append(last)
        return [self._grid.point(one) for one in (*corners, cells[-1])]

    def _clear(self, start: Cell, end: Cell) -> bool:
        steps = 2 * max(abs(end[0] - start[0]), abs(end[1] - start[1]), 1)  # half cells, so that none is skipped
        return not any(
            self._close[
                round(start[0] + (end[0] - start[0]) * index / steps),
                round(start[1] + (end[1] - start[1]) * index / steps),
            ]
            for index in range(steps + 1)
        )


_REACHED: Final = 0.1  # tolerance of a goal in metres; then the heading is turned to, within `_TURNED` radians

_TURNED: Final = 0.06
_PASSED: Final = 0.25
_ABOUT: Final = 0.6  # angle in radians above which the robot turns on the spot

_STOP: Final = 0.08


class Follower:
    """Follows points to the last one and its heading; `done` at the end."""

    def __init__(self, points: Sequence[tuple[float, float]], heading: float) -> None:
        self._points = list(points)
        self._heading = heading
        self.done = False

    def left(self, pose: Pose) -> float:
        """Return the remaining distance in metres."""
        points = [(pose.x, pose.y), *self._points]
        return sum(math.dist(one, two) for one, two in pairwise(points))

    def next(self, pose: Pose, ranges: Sequence[float]) -> Command:
        """Return the velocity for the next tenth of a second."""
        while len(self._points) > 1 and pose.distance(*self._points[0]) < _PASSED:
            self._points.pop(0)
        if self._points and (len(self._points) > 1 or pose.distance(*self._points[0]) > _REACHED):
            return self._onwards(pose, ranges)
        self._points.clear()
        off = wrapped(self._heading - pose.heading)
        self.done = abs(off) < _TURNED
        return Command() if self.done else Command(turn=_turning(off))

    def _onwards(self, pose: Pose, ranges: Sequence[float]) -> Command:
        x, y = self._points[0]
        off = wrapped(math.atan2(y - pose.y, x - pose.x) - pose.heading)
        if abs(off) > _ABOUT:
            return Command(turn=_turning(off))
        slow = min(1.0, max(0.25, pose.distance(x, y)))
        room = free_ahead(ranges) - _STOP
        return Command(forward=max(0.0, min(SPEED * slow * math.cos(off) ** 2, 1.2 * room)), turn=2.0 * off)


def _turning(off: float) -> float:
    return math.copysign(min(1.5, max(0.25, 2.0 * abs(off))), off)


def free_ahead(ranges: Sequence[float]) -> float:
    """Return the free distance ahead in metres, from a scan that starts at the rear."""
    free = math.inf
    for index, length in enumerate(ranges):
        angle = -math.pi + index * math.tau / len(ranges)
        ahead, aside = length * math.cos(angle), length * math.sin(angle)
        if ahead > 0 and abs(aside) <= RADIUS + 0.02:
            free = min(free, ahead - RADIUS)
    return free


_PERIOD: Final = 0.1
_PATIENCE: Final = 12.0  # seconds without progress after which a goal is aborted

_NEARER: Final = 0.05


@dataclass(frozen=True, slots=True)
class _Names:
    action: str
    kind: str
    simple: str
    goal: str


_NAMES: Final = {
    1: _Names("/move_base", "move_base_msgs/MoveBase", "/move_base_simple/goal", "target_pose"),
    2: _Names("/navigate_to_pose", "nav2_msgs/NavigateToPose", "/goal_pose", "pose"),
}


class Navigator:
    """Drives the robot to goals, one at a time; a new goal replaces the current one."""

    def __init__(self, node: Node, robot: Wheeled) -> None:
        self._node = node
        self._robot = robot
        self._names = _NAMES[node.connection.ros]
        self._planner = Planner(node.stage.world.plan, RADIUS)
        self._ranges: list[float] = []
        self._velocity: Publication

    async def begin(self) -> None:
        """Serve the action and subscribe to the topic for simple goals."""
        self._velocity = await self._node.advertise("/cmd_vel", "geometry_msgs/Twist")
        await self._node.hear("/scan", "sensor_msgs/LaserScan", self._scanned, queue=1)
        await self._node.hear("/odom", "nav_msgs/Odometry", lambda _: None, queue=1)
        await self._node.hear(self._names.simple, "geometry_msgs/PoseStamped", self._go, queue=1)
        await self._node.connection.serve_action(self._names.action, self._names.kind, self._carry_out)

    def _scanned(self, value: Value) -> None:
        self._ranges = value["ranges"]

    async def _go(self, goal: Value) -> None:
        """Drive to a simple goal: like `move_base`, the node sends it to its own action and ignores the result."""
        names = self._names
        await self._node.connection.send_goal(names.action, names.kind, {names.goal: goal}, seconds=_PATIENCE)

    async def _carry_out(self, accepted: Accepted) -> Value:
        pose = accepted.goal[self._names.goal]["pose"]
        place, heading = pose["position"], heading_of(pose["orientation"])
        now = self._robot.located()
        way = self._planner.way((now.x, now.y), (place["x"], place["y"]))
        if way is None:
            accepted.abort(f"no path to x = {place['x']:g} m, y = {place['y']:g} m")
        else:
            await self._follow(accepted, Follower(way, heading))
        return {}

    async def _follow(self, accepted: Accepted, follower: Follower) -> None:
        clock = self._node.stage.world.clock
        nearest, since = math.inf, clock.now()
        while not accepted.cancelled:
            pose = self._robot.located()
            await self._drive(follower.next(pose, self._ranges))
            if follower.done:
                return
            left = follower.left(pose)
            if left < nearest - _NEARER:
                nearest, since = left, clock.now()
            elif clock.now() - since > _PATIENCE:
                accepted.abort(f"the robot is not getting closer, {left:.1f} m before its goal")
                break
            stamped = {"header": self._node.stage.header("map"), "pose": posed(pose)}
            ros1 = self._node.connection.ros == 1
            progress = {"base_position": stamped} if ros1 else {"current_pose": stamped, "distance_remaining": left}
            await accepted.feedback(progress)
            await clock.sleep(_PERIOD)
        await self._drive(Command())

    async def _drive(self, command: Command) -> None:
        await self._velocity.publish({"linear": point(command.forward, 0), "angular": point(0, 0, command.turn)})
