from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import pytest
from patience import patient

from kg.errors import RobotError, UsageError
from kg.robot.bag.recording import SUFFIXES, Recorder
from kg.robot.clock import WallClock
from kg.robot.connecting import connect
from kg.robot.memory import Bus

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from kg.robot.connection import GraphProblem


@pytest.fixture(params=[1, 2])
def bus(request: pytest.FixtureRequest) -> Iterator[Bus]:
    """Yield a robot in memory for each version of ROS."""
    with Bus(uuid4().hex, ros=request.param, clock=WallClock()) as made:
        yield made


def _path(bus: Bus, folder: Path) -> Path:
    return folder / f"drive{SUFFIXES[bus.ros]}"


async def _until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(patient(2)):
        while not true():  # noqa: ASYNC110 - the recorder tells nobody
            await asyncio.sleep(0.005)


async def _read(path: Path, topic: str) -> list[dict[str, Any]]:
    connection = await connect(f"bag://{path}?speed=100", name="/reader")
    try:
        return [one.value async for one in await connection.subscribe(topic, queue=1000)]
    finally:
        await connection.aclose()


def test_what_is_recorded_is_read_again(bus: Bus, tmp_path: Path) -> None:
    """All topics are recorded in one file with their types and read back unchanged; no other files remain."""

    async def scene() -> None:
        robot, face = bus.join("/robot"), bus.join("/kg")
        speeds = await robot.advertise("/speed", "geometry_msgs/Twist")
        texts = await robot.advertise("/text", "std_msgs/String")
        told: list[str] = []
        recorder = Recorder(face, _path(bus, tmp_path), begun=lambda topic, _: told.append(topic))
        running = asyncio.ensure_future(recorder.run())
        await _until(lambda: told == ["/speed", "/text"])
        for number in range(5):
            await speeds.publish({"linear": {"x": float(number)}})
        await texts.publish({"data": "höher"})
        await _until(lambda: recorder.written == 6)
        running.cancel()
        with pytest.raises(asyncio.CancelledError):
            await running
        done = recorder.close()
        assert [(one.topic, one.messages, one.dropped) for one in done] == [("/speed", 5, 0), ("/text", 1, 0)]
        came = await _read(_path(bus, tmp_path), "/speed")
        assert [one["linear"]["x"] for one in came] == [0.0, 1.0, 2.0, 3.0, 4.0]
        assert await _read(_path(bus, tmp_path), "/text") == [{"data": "höher"}]

    asyncio.run(scene())
    assert [one.name for one in tmp_path.iterdir()] == [_path(bus, tmp_path).name]


def test_topics_that_come_later_are_recorded(bus: Bus, tmp_path: Path) -> None:
    """A topic published later is recorded from then on; an unrequested one is not."""

    async def scene() -> None:
        robot, face = bus.join("/robot"), bus.join("/kg")
        told: list[str] = []
        recorder = Recorder(
            face, _path(bus, tmp_path), topics=frozenset({"/late"}), begun=lambda topic, _: told.append(topic)
        )
        running = asyncio.ensure_future(recorder.run())
        await robot.advertise("/other", "std_msgs/String")
        late = await robot.advertise("/late", "std_msgs/String")
        await _until(lambda: told == ["/late"])
        await late.publish({"data": "here"})
        await _until(lambda: recorder.written == 1)
        running.cancel()
        await asyncio.wait({running})
        recorder.close()
        assert await _read(_path(bus, tmp_path), "/late") == [{"data": "here"}]

    asyncio.run(scene())


def test_the_file_is_complete_when_the_robot_is_lost(bus: Bus, tmp_path: Path) -> None:
    """Losing the robot ends the recording with KG803; the file has all messages received."""

    async def scene() -> None:
        robot, face = bus.join("/robot"), bus.join("/kg")
        texts = await robot.advertise("/text", "std_msgs/String")
        recorder = Recorder(face, _path(bus, tmp_path))
        running = asyncio.ensure_future(recorder.run())
        await _until(lambda: texts.peers == 1)
        await texts.publish({"data": "last words"})
        face.lose("the cable was pulled")
        with pytest.raises(RobotError) as lost:
            await asyncio.wait_for(running, patient(2))
        assert lost.value.code == "KG803"
        recorder.close()
        assert await _read(_path(bus, tmp_path), "/text") == [{"data": "last words"}]

    asyncio.run(scene())


def test_a_recording_is_recorded(bus: Bus, tmp_path: Path) -> None:
    """Part of a recording becomes another one, with the original times and publishers; its end is not an error."""

    async def scene() -> None:
        robot, face = bus.join("/robot"), bus.join("/kg")
        texts = await robot.advertise("/text", "std_msgs/String", latch=True)
        await texts.publish({"data": "once"})
        first = Recorder(face, _path(bus, tmp_path))
        running = asyncio.ensure_future(first.run())
        await _until(lambda: first.written == 1)
        running.cancel()
        await asyncio.wait({running})
        first.close()
        connection = await connect(f"bag://{_path(bus, tmp_path)}", name="/kg")
        again = Recorder(connection, tmp_path / f"again{SUFFIXES[bus.ros]}")
        await again.run()
        again.close()
        copy = await connect(f"bag://{tmp_path}/again{SUFFIXES[bus.ros]}", name="/kg")
        assert copy.clock.now() == pytest.approx(first.first, abs=1e-6)
        assert {one.name for one in (await copy.graph()).nodes} == {"/robot" if bus.ros == 1 else "/_recorded"}
        await copy.aclose()
        await connection.aclose()

    asyncio.run(scene())


def test_without_a_message_there_is_no_file(bus: Bus, tmp_path: Path) -> None:
    """The file is created with the first message."""

    async def scene() -> None:
        bus.join("/robot")
        recorder = Recorder(bus.join("/kg"), _path(bus, tmp_path))
        running = asyncio.ensure_future(recorder.run())
        await asyncio.sleep(0)
        running.cancel()
        await asyncio.wait({running})
        assert recorder.close() == ()

    asyncio.run(scene())
    assert list(tmp_path.iterdir()) == []


def test_a_topic_of_an_unknown_type_is_left_out(bus: Bus, tmp_path: Path) -> None:
    """The topic is reported once with its code, and the others are recorded."""

    async def scene() -> None:
        robot, face = bus.join("/robot"), bus.join("/kg")
        odd = await robot.advertise("/odd", "std_msgs/String")
        odd.kind = bus.topics["/odd"].kind = "kg_test/Odd"  # an undefined type
        text = await robot.advertise("/text", "std_msgs/String")
        problems: list[GraphProblem] = []
        recorder = Recorder(face, _path(bus, tmp_path), on_problem=problems.append)
        running = asyncio.ensure_future(recorder.run())
        await _until(lambda: text.peers == 1)
        await text.publish({"data": "here"})
        await _until(lambda: recorder.written == 1)
        assert [(one.code, one.subject) for one in problems] == [("KG804", "/odd")]
        running.cancel()
        await asyncio.wait({running})

    asyncio.run(scene())


def test_a_file_that_exists_or_is_of_the_other_ros_is_refused(bus: Bus, tmp_path: Path) -> None:
    """No file is overwritten, and the format must match the version of ROS (KG003)."""

    async def scene() -> None:
        face = bus.join("/kg")
        _path(bus, tmp_path).write_bytes(b"mine")
        for path in (_path(bus, tmp_path), tmp_path / f"drive{SUFFIXES[3 - bus.ros]}"):
            with pytest.raises(UsageError) as refused:
                Recorder(face, path)
            assert refused.value.code == "KG003"
        assert _path(bus, tmp_path).read_bytes() == b"mine"

    asyncio.run(scene())
