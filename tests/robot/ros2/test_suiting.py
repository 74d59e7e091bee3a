"""Readers that adapt to the offers of publishers, and writers that adapt to the requests of subscribers."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, cast

from patience import patient

from kg.facts import Qos, Role
from kg.robot.connection import LiveEnd, LiveNode
from kg.robot.messages import Types
from kg.robot.ros2.address import Address
from kg.robot.ros2.connection import Ros2Connection
from kg.robot.ros2.graph import Watch
from kg.robot.ros2.middleware import LATCHED, OFFERED, Neighbourhood

if TYPE_CHECKING:
    from kg.robot.ros2.middleware import Middleware


class _Wire:
    """A middleware with one publisher, which rejects the second reader."""

    def __init__(self) -> None:
        self.types = Types(2)
        self.offered = OFFERED
        self.asked: list[Qos] = []
        self.offers: list[Qos] = []
        self.closed = 0

    def neighbourhood(self) -> Neighbourhood:
        end = LiveEnd("/robot", Role.PUBLISHES, "/said", "std_msgs/String", self.offered)
        heard = [
            LiveEnd("/robot", Role.SUBSCRIBES, "/kept", "std_msgs/String", LATCHED),
            LiveEnd("/robot", Role.SUBSCRIBES, "/plain", "std_msgs/String", OFFERED),
        ]
        return Neighbourhood((LiveNode("/robot"),), (end, *heard))

    def writer(self, _topic: str, _kind: str, qos: Qos) -> Any:
        self.offers.append(qos)
        return self

    def reader(self, _topic: str, _kind: str, qos: Qos, _deliver: Any) -> Any:
        self.asked.append(qos)
        if len(self.asked) == len(("first", "second")):
            raise OSError("no more handles")
        return self

    def write(self, _content: bytes) -> None:
        """Drop what is logged."""

    def close(self) -> None:
        self.closed += 1


def test_a_reader_that_cannot_be_opened_is_told_and_tried_again() -> None:
    """If a reader cannot adapt to an offer, the graph has the problem, and the next graph retries."""

    async def scene() -> tuple[list[str], list[str]]:
        wire = _Wire()
        watch = Watch(wire.neighbourhood, 0.0)
        connection = Ros2Connection(cast("Middleware", wire), watch, Address("dds://0", "0"), "/face")
        await connection.subscribe("/said", "std_msgs/String")
        wire.offered = LATCHED
        watch.changed()
        async with asyncio.timeout(patient(10)):
            while len(wire.asked) < len(("first", "second", "third")):  # noqa: ASYNC110 - a list tells nobody
                await asyncio.sleep(0.01)
        problems = [f"{one.code} {one.subject} {one.message}" for one in watch.now().problems]
        await connection.aclose()
        return problems, [qos.durability for qos in wire.asked if qos.durability]

    problems, asked = asyncio.run(scene())
    assert problems == ["KG803 /said it cannot be read any more: no more handles"]
    assert asked == ["volatile", "transient_local", "transient_local"]


def test_a_subscriber_that_asks_for_earlier_messages_is_offered_them() -> None:
    """A volatile writer would not match it; other subscribers get the default offer."""

    async def scene() -> list[Qos]:
        wire = _Wire()
        watch = Watch(wire.neighbourhood, 0.0)
        connection = Ros2Connection(cast("Middleware", wire), watch, Address("dds://0", "0"), "/face")
        for topic in ("/kept", "/plain"):
            await connection.advertise(topic, "std_msgs/String")
        await connection.aclose()
        return wire.offers

    assert asyncio.run(scene()) == [LATCHED, OFFERED]


def test_a_topic_that_is_no_longer_published_is_forgotten() -> None:
    """A closed publication is not kept until the connection closes, which closes only what is still open."""

    async def scene() -> int:
        wire = _Wire()
        watch = Watch(wire.neighbourhood, 0.0)
        connection = Ros2Connection(cast("Middleware", wire), watch, Address("dds://0", "0"), "/face")
        publication = await connection.advertise("/plain", "std_msgs/String")
        await publication.aclose()
        await connection.aclose()
        return wire.closed

    assert asyncio.run(scene()) == len(("the publication", "the middleware"))
