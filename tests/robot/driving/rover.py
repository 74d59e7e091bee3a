"""A robot in memory with handmade capabilities, and a record of the commands it received."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from msgspec.structs import replace
from patience import patient
from robot.connections import types_for_tests

from kg.robot.capability import Capabilities, Capability, Parameter, Way
from kg.robot.clock import WallClock
from kg.robot.driving import Driver, Watchdog
from kg.robot.memory import Bus

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.clock import Clock
    from kg.robot.connection import Accepted, Connection, Publication, Subscription, Value

__all__ = ["CAPABILITIES", "ONE_PART", "Rover", "rover", "until"]


def _speed(name: str, label: str, unit: str, most: float) -> Parameter:
    return Parameter(name=name, label=label, unit=unit, default=0.0, minimum=-most, maximum=most)


DRIVING = Capability(
    iri="#drivingAtVelocity",
    name="drivingAtVelocity",
    label="Driving at a velocity",
    alternatives=("driving", "moving"),
    kinds=("Movement",),
    modality="write",
    parameters=(
        _speed("forward", "forward speed", "m/s", 1.0),
        _speed("turn", "turning speed", "rad/s", 2.0),
        _speed("up", "upward speed", "m/s", 1.0),
    ),
    ways=(
        Way(
            kind="topic",
            name="/cmd_vel",
            type="geometry_msgs/Twist",
            node="/rover",
            fields={"forward": "linear.x", "turn": "angular.z"},
            rate=20,
        ),
        Way(
            kind="topic",
            name="/stamped",
            type="geometry_msgs/TwistStamped",
            node="/flyer",
            fields={"forward": "twist.linear.x", "turn": "twist.angular.z", "up": "twist.linear.z"},
            constants={"header.frame_id": "base"},
            rate=20,
        ),
    ),
)
COUNTING = Capability(
    iri="#counting",
    name="counting",
    label="Counting",
    modality="write",
    parameters=(
        Parameter(name="until", label="until", type="integer", minimum=0, unit=None),
        Parameter(name="now", label="now", type="integer", default=0),
    ),
    ways=(
        Way(kind="action", name="/count", type="kg_test/Count", node="/rover", fields={"until": "until", "now": "now"}),
    ),
)
DOUBLING = Capability(
    iri="#doubling",
    name="doubling",
    label="Doubling",
    modality="write",
    parameters=(Parameter(name="value", label="value", unit="m"),),
    ways=(Way(kind="service", name="/double", type="kg_test/Double", node="/rover", fields={"value": "value"}),),
)
SAYING = Capability(
    iri="#saying",
    name="saying",
    label="Saying",
    modality="write",
    parameters=(Parameter(name="words", label="words", type="text", choices=("hello", "goodbye")),),
    ways=(Way(kind="topic", name="/say", type="std_msgs/String", node="/rover", fields={"words": "data"}),),
)
SCANNING = Capability(
    iri="#laserScanning",
    name="laserScanning",
    label="Laser scanning",
    modality="read",
    parameters=(
        Parameter(name="nearest", label="nearest", unit="m"),
        Parameter(name="ahead", label="ahead", unit="m"),
    ),
    ways=(
        Way(
            kind="topic",
            name="/scan",
            type="sensor_msgs/LaserScan",
            node="/rover",
            fields={"nearest": "minimum(ranges)", "ahead": "at(ranges,0)"},
        ),
    ),
)
WHERE = Capability(
    iri="#sensingPose",
    name="sensingPose",
    label="Sensing where it is",
    modality="read",
    parameters=(Parameter(name="x", label="x", unit="m"), Parameter(name="heading", label="heading", unit="rad")),
    ways=(
        Way(
            kind="topic",
            name="/odom",
            type="nav_msgs/Odometry",
            node="/rover",
            fields={"x": "pose.pose.position.x", "heading": "yaw(pose.pose.orientation)"},
        ),
    ),
)
FLYING = Capability(iri="#flying", name="flying", label="Flying", modality="write", implied_by=("takingOff",))
MEASURING = Capability(
    iri="#measuring",
    name="measuring",
    label="Measuring",
    modality="read",
    parameters=(Parameter(name="remark", label="remark", type="text"),),
    ways=(Way(kind="service", name="/double", type="kg_test/Double", node="/rover", fields={"remark": "remark"}),),
)

CAPABILITIES = Capabilities(
    of="the rover",
    capabilities=(DRIVING, COUNTING, DOUBLING, SAYING, SCANNING, WHERE, FLYING, MEASURING),
)
ONE_PART = Capabilities(
    of="the rover",
    capabilities=(replace(DRIVING, moves="base"), replace(COUNTING, moves="base"), DOUBLING, SAYING),
)
"""The rover, with driving and counting on the same part."""


@dataclass
class Rover:
    """A robot that records its commands, and its driver."""

    bus: Bus
    node: Connection
    face: Connection
    driver: Driver
    told: dict[str, list[Value]] = field(default_factory=dict)
    goals: list[Value] = field(default_factory=list)
    cancelled: int = 0
    publications: dict[str, Publication] = field(default_factory=dict)

    def speeds(self, topic: str = "/cmd_vel") -> list[float]:
        """Return the forward speeds received on a topic."""
        return [one.get("twist", one)["linear"]["x"] for one in self.told.get(topic, [])]

    async def listen(self, topic: str, kind: str) -> Subscription:
        """Record the messages of a topic."""
        subscription = await self.node.subscribe(topic, kind, queue=10_000)

        async def record() -> None:
            async for received in subscription:
                self.told.setdefault(topic, []).append(received.value)

        task = asyncio.ensure_future(record())
        _running.add(task)
        task.add_done_callback(_running.discard)
        return subscription

    async def tell(self, topic: str, kind: str, value: Value) -> None:
        """Publish a message."""
        if topic not in self.publications:
            self.publications[topic] = await self.node.advertise(topic, kind)
        await self.publications[topic].publish(value)

    async def count(self, accepted: Accepted) -> Value:
        """Execute a goal that counts, a step every 10 ms."""
        self.goals.append(accepted.goal)
        now = 0
        try:
            while now < accepted.goal["until"] and not accepted.cancelled:
                now += 1
                await accepted.feedback({"now": now})
                await asyncio.sleep(0.01)
        finally:
            self.cancelled += accepted.cancelled
        return {"reached": now}


_running: set[asyncio.Task[Any]] = set()


@asynccontextmanager
async def rover(
    clock: Clock | None = None,
    *,
    capabilities: Capabilities = CAPABILITIES,
    watchdog: Watchdog | None = None,
    listen: float = 0.3,
) -> AsyncIterator[Rover]:
    """Yield a rover that subscribes, serves and counts, with an open driver."""
    with Bus(uuid4().hex, clock=clock or WallClock(), types=types_for_tests(1)) as bus:
        node, face = bus.join("/rover"), bus.join("/face")
        async with Driver(face, capabilities, listen=listen, watchdog=watchdog) as driver:
            made = Rover(bus, node, face, driver)
            await made.listen("/cmd_vel", "geometry_msgs/Twist")
            await node.serve("/double", "kg_test/Double", _double)
            await node.serve_action("/count", "kg_test/Count", made.count)
            yield made


async def _double(request: Value) -> Value:
    if request["value"] < 0:
        raise ValueError("negative")
    return {"value": 2 * request["value"], "remark": "twice"}


async def until(true: Any) -> None:
    """Return when a condition holds, or fail after some seconds."""
    async with asyncio.timeout(patient(20)):
        while not true():  # noqa: ASYNC110 - the tests look from outside
            await asyncio.sleep(0.005)
