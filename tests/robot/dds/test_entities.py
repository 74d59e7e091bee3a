"""Readers and writers of DDS, below the connection."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Literal

import pytest
from patience import patient
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.dds.entities import DdsWriter
from kg.robot.ros2.middleware import OFFERED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.ros2 import Ros2Connection


def test_a_peer_that_comes_while_peers_are_counted() -> None:
    """Peers are counted again if one joined during the count and the library's list was too short."""

    async def scene() -> None:
        answers: Iterator[IndexError | list[int]] = iter([IndexError("invalid index"), [1, 2]])

        def handles() -> list[int]:
            answer = next(answers)
            if isinstance(answer, IndexError):
                raise answer
            return answer

        writer = object.__new__(DdsWriter)
        writer._closed = False
        writer._entity = SimpleNamespace(get_matched_subscriptions=handles)
        assert writer.peers == 2

    asyncio.run(scene())


@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_only_reliable_readers_confirm(reliability: Literal["reliable", "best_effort"]) -> None:
    """With a best-effort reader, nobody knows whether messages arrived."""

    async def scene() -> bool:
        with domain() as number:
            one: Ros2Connection = await connect(f"dds://{number}?settle=0")  # type: ignore[assignment]  # by DDS
            two: Ros2Connection = await connect(f"dds://{number}?settle=0")  # type: ignore[assignment]  # by DDS
            received = asyncio.Event()
            qos = replace(OFFERED, reliability=reliability)
            two.wire.reader("/said", "std_msgs/String", qos, lambda *_: received.set())
            writer = one.wire.writer("/said", "std_msgs/String", OFFERED)
            async with asyncio.timeout(patient(10)):
                await writer.ready()
                writer.write(one.types.encode("std_msgs/String", {"data": "stop"}))
                await received.wait()
                while reliability == "reliable" and not writer.confirmed:  # noqa: ASYNC110 - nothing tells it
                    await asyncio.sleep(0.01)
            confirmed = writer.confirmed
            await one.aclose()
            await two.aclose()
            return confirmed

    assert asyncio.run(scene()) == (reliability == "reliable")


def test_who_waits_for_a_peer_learns_that_the_connection_is_closed() -> None:
    """Waiting for a peer of a service or topic ends with KG803 when the connection is closed."""

    async def scene() -> list[str]:
        with domain() as number:
            connection: Ros2Connection = await connect(f"dds://{number}?settle=0")  # type: ignore[assignment]  # by DDS
            writer = connection.wire.writer("/said", "std_msgs/String", OFFERED)
            caller = connection.wire.caller("/ask", "std_srvs/Trigger")
            waiting = asyncio.gather(writer.ready(), caller.call(b""), return_exceptions=True)
            await asyncio.sleep(0)
            writer.close()
            caller.close()
            found = await asyncio.wait_for(waiting, patient(5))
            await connection.aclose()
        return [one.code for one in found if isinstance(one, RobotError)]

    assert asyncio.run(scene()) == ["KG803", "KG803"]
