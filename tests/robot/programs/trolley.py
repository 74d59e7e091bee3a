"""A trolley that rolls towards a wall, in memory, to run programs of tests faster than real time."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from kg.robot.capability import Capabilities, Capability, Parameter, Way
from kg.robot.clock import SimulatedClock
from kg.robot.driving import Driver
from kg.robot.memory import Bus
from kg.robot.messages import Types

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.connection import Accepted, Connection, Value

__all__ = ["CAPABILITIES", "Trolley", "trolley"]

_STEP = 0.05
_WALL = 3.0


def _length(name: str, **more: Any) -> Parameter:
    return Parameter(name=name, label=name, unit="m", **more)


def _topic(name: str, kind: str, *, rate: float = 0, **fields: str) -> tuple[Way, ...]:
    return (Way(kind="topic", name=name, type=kind, node="/trolley", fields=fields, rate=rate),)


_DRIVING = Capability(
    iri="#drivingAtVelocity",
    name="drivingAtVelocity",
    label="move at a velocity",
    kinds=("movement", "locomotion"),
    moves="base",
    modality="write",
    parameters=(
        Parameter(name="forward", label="forward speed", unit="m/s", default=0.0, minimum=-1.0, maximum=1.0),
        Parameter(name="turn", label="turning speed", unit="rad/s", default=0.0, minimum=-2.0, maximum=2.0),
    ),
    ways=_topic("/cmd_vel", "geometry_msgs/Twist", rate=10, forward="linear.x", turn="angular.z"),
)
_GOING = Capability(
    iri="#goingToPose",
    name="goingToPose",
    label="go to a pose",
    kinds=("movement", "locomotion"),
    moves="base",
    modality="write",
    parameters=(
        _length("x"),
        _length("y", default=0.0),
        Parameter(name="heading", label="heading", unit="rad", default=0.0),
    ),
    ways=(
        Way(
            kind="action",
            name="/move_base",
            type="move_base_msgs/MoveBase",
            node="/trolley",
            fields={
                "x": "target_pose.pose.position.x",
                "y": "target_pose.pose.position.y",
                "heading": "yaw(target_pose.pose.orientation)",
            },
            constants={"target_pose.header.frame_id": "map"},
        ),
    ),
)
_SAYING = Capability(
    iri="#saying",
    name="saying",
    label="say something",
    kinds=("interaction",),
    modality="write",
    parameters=(Parameter(name="words", label="words", type="text", choices=("hello", "goodbye")),),
    ways=_topic("/say", "std_msgs/String", words="data"),
)
_SCANNING = Capability(
    iri="#laserScanning",
    name="laserScanning",
    label="scan with a laser",
    kinds=("sensing", "ranging"),
    modality="read",
    parameters=(_length("nearest"), _length("ahead")),
    ways=_topic("/scan", "sensor_msgs/LaserScan", nearest="minimum(ranges)", ahead="at(ranges,0)"),
)
_POSE = Capability(
    iri="#sensingPose",
    name="sensingPose",
    label="sense its pose",
    kinds=("sensing", "localization"),
    modality="read",
    parameters=(_length("x"), _length("y"), Parameter(name="heading", label="heading", unit="rad")),
    ways=_topic(
        "/odom",
        "nav_msgs/Odometry",
        x="pose.pose.position.x",
        y="pose.pose.position.y",
        heading="yaw(pose.pose.orientation)",
    ),
)
_BUMPERS = Capability(
    iri="#sensingContact",
    name="sensingContact",
    label="sense contact",
    kinds=("sensing",),
    modality="read",
    parameters=(
        Parameter(name="pressed", label="pressed", type="boolean"),
        Parameter(name="places", label="places", type="list"),
    ),
    ways=_topic("/bumpers", "std_msgs/Bool", pressed="data"),
)
_FLYING = Capability(iri="#flying", name="flying", label="fly", modality="write", kinds=("movement",))

CAPABILITIES = Capabilities(
    of="the trolley", capabilities=(_DRIVING, _GOING, _SAYING, _SCANNING, _POSE, _BUMPERS, _FLYING)
)


class Trolley:
    """Position and speed of the trolley, and its commands."""

    def __init__(self, node: Connection, clock: SimulatedClock) -> None:
        self.place = 0.0
        self.speed = 0.0
        self.fastest = 0.0
        self.said: list[str] = []
        self.goals: list[float] = []
        self.cancelled = 0
        self._node = node
        self.clock = clock

    async def live(self) -> None:
        """Roll, publish the position, and advance time, twenty times as fast as real time."""
        odometry = await self._node.advertise("/odom", "nav_msgs/Odometry")
        scan = await self._node.advertise("/scan", "sensor_msgs/LaserScan")
        listening = [asyncio.ensure_future(self._drive()), asyncio.ensure_future(self._say())]
        try:
            while True:
                self.place += self.speed * _STEP
                await odometry.publish({"pose": {"pose": {"position": {"x": self.place}, "orientation": {"w": 1.0}}}})
                ranges = [5.0, _WALL - self.place, 5.0]
                limits = {"angle_min": -0.5, "angle_increment": 0.5, "range_max": 10.0}
                await scan.publish({"ranges": ranges, **limits})
                await asyncio.sleep(_STEP / 20)
                self.clock.set_time(self.clock.now() + _STEP)
        finally:
            for task in listening:
                task.cancel()
            await asyncio.gather(*listening, return_exceptions=True)

    async def _drive(self) -> None:
        async for received in await self._node.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=1000):
            self.speed = received.value["linear"]["x"]
            self.fastest = max(self.fastest, self.speed)

    async def _say(self) -> None:
        async for received in await self._node.subscribe("/say", "std_msgs/String", queue=1000):
            self.said.append(received.value["data"])

    async def go(self, accepted: Accepted) -> Value:
        """Execute a goal at 1 m/s; places behind the wall cannot be reached."""
        target = accepted.goal["target_pose"]["pose"]["position"]["x"]
        self.goals.append(target)
        if target > _WALL:
            accepted.abort("there is a wall")
            return {}
        self.speed = 1.0 if target > self.place else -1.0
        try:
            while abs(target - self.place) > _STEP and not accepted.cancelled:
                await self.clock.sleep(_STEP)
        finally:
            self.speed = 0.0
            self.cancelled += accepted.cancelled
        return {}


@asynccontextmanager
async def trolley(capabilities: Capabilities = CAPABILITIES) -> AsyncIterator[tuple[Trolley, Driver]]:
    """Yield a running trolley, with an open driver."""
    clock = SimulatedClock()
    clock.set_time(100.0)
    with Bus(uuid4().hex, clock=clock, types=Types(1)) as bus:
        node, face = bus.join("/trolley"), bus.join("/face")
        made = Trolley(node, clock)
        await node.serve_action("/move_base", "move_base_msgs/MoveBase", made.go)
        living = asyncio.ensure_future(made.live())
        await asyncio.sleep(0.01)
        try:
            async with Driver(face, capabilities, listen=1.0) as driver:
                yield made, driver
        finally:
            living.cancel()
            with suppress(asyncio.CancelledError):
                await living
