"""The node that carries out goals, as `move_base` of ROS 1 and the navigator of Nav2 do."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.following import Follower
from kg.robot.simulation.planning import Planner
from kg.robot.simulation.pose import heading_of
from kg.robot.simulation.robots import Command
from kg.robot.simulation.stage import Node, point, posed
from kg.robot.simulation.wheeled import RADIUS, Wheeled

if TYPE_CHECKING:
    from kg.robot.connection import Accepted, Publication, Value
    from kg.robot.simulation.pose import Pose

__all__ = ["Navigator"]

_PERIOD: Final = 0.1
_PATIENCE: Final = 12.0
"""Seconds without coming nearer after which a goal is given up."""

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
    """Drives the robot to goals, one at a time; a newer one takes the place of the one before."""

    def __init__(self, node: Node, robot: Wheeled) -> None:
        self._node = node
        self._robot = robot
        self._names = _NAMES[node.connection.ros]
        self._planner = Planner(node.stage.world.plan, RADIUS)
        self._ranges: list[float] = []
        self._velocity: Publication

    async def begin(self) -> None:
        """Offer the action and the topic for simple goals."""
        self._velocity = await self._node.tell("/cmd_vel", "geometry_msgs/Twist")
        await self._node.hear("/scan", "sensor_msgs/LaserScan", self._scanned, queue=1)
        await self._node.hear("/odom", "nav_msgs/Odometry", lambda _: None, queue=1)
        await self._node.hear(self._names.simple, "geometry_msgs/PoseStamped", self._go, queue=1)
        await self._node.connection.serve_action(self._names.action, self._names.kind, self._carry_out)

    def _scanned(self, value: Value) -> None:
        self._ranges = value["ranges"]

    async def _go(self, goal: Value) -> None:
        """Drive to a simple goal: like `move_base`, the node gives it to its own action and tells nobody the result."""
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
                accepted.abort(f"the robot comes no nearer, {left:.1f} m before its goal")
                break
            await accepted.feedback(self._progress(pose, left))
            await clock.sleep(_PERIOD)
        await self._drive(Command())

    async def _drive(self, command: Command) -> None:
        await self._velocity.publish({"linear": point(command.forward, 0), "angular": point(0, 0, command.turn)})

    def _progress(self, pose: Pose, left: float) -> Value:
        stamped = {"header": self._node.stage.header("map"), "pose": posed(pose)}
        if self._node.connection.ros == 1:
            return {"base_position": stamped}
        return {"current_pose": stamped, "distance_remaining": left}
