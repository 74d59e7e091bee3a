from __future__ import annotations

import asyncio
import threading
from contextlib import aclosing
from typing import TYPE_CHECKING
from uuid import uuid4

import pytest
from patience import patient
from robot.connections import types_for_tests

from kg.codes import CATALOGUE
from kg.errors import RobotError
from kg.graph.reading.systems import system_names, systems
from kg.robot.connection import ComputationGraph, LiveNode
from kg.robot.live import Event, Watching
from kg.robot.live.keeping import Keeper, StoredState
from kg.robot.live.watching import _differences
from kg.robot.memory import Bus

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Iterator

    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore


@pytest.fixture
def bus() -> Iterator[Bus]:
    """Yield a system in memory."""
    with Bus(uuid4().hex, types=types_for_tests(1)) as made:
        yield made


async def _until(events: AsyncIterator[Event], true: Callable[[Event], bool]) -> list[Event]:
    """Return the events up to the first that satisfies a condition."""
    found: list[Event] = []
    async with asyncio.timeout(patient(20)):
        async for event in events:
            found.append(event)
            if true(event):
                return found
    raise AssertionError(found)


def _told(events: list[Event], kind: str) -> set[tuple[str | None, str]]:
    return {(one.change, one.name) for one in events if one.event == kind}


def _kept(event: Event) -> bool:
    return event.event == "kept"


def test_what_comes_and_goes_is_told_and_kept(bus: Bus, store: EmbeddedStore, settings: Settings) -> None:
    """Changes of nodes, ends and capabilities are reported, and the store is up to date."""

    async def run() -> tuple[list[Event], list[Event], list[Event]]:
        watching = Watching(store, settings, address=bus.address, name="office")
        base = bus.join("/base")
        await base.subscribe("/cmd_vel", "geometry_msgs/Twist")
        async with aclosing(watching.events()) as events:
            first = await _until(events, _kept)
            laser = bus.join("/laser")
            await laser.advertise("/scan", "sensor_msgs/LaserScan")
            came = await _until(events, lambda event: event.name == "laserScanning")
            await laser.aclose()
            went = await _until(events, lambda event: event.change == "went" and event.event == "capability")
        await watching.end()
        return first, came, went

    first, came, went = asyncio.run(run())
    assert first[0].event == "watching"
    assert ("came", "/base") in _told(first, "node")
    assert ("came", "drivingAtVelocity") in _told(first, "capability")
    assert ("came", "/laser publishes /scan") in _told(came, "end")
    assert ("came", "laserScanning") in _told(came, "capability")
    assert ("went", "/laser") in _told(went, "node")
    with store.read() as snapshot:
        (found,) = systems(snapshot, system_names(snapshot), settings.base)
    assert found.configuration.name == "robot/office"
    assert [one.name for one in found.instances] == ["/base"]
    assert found.sighting is not None
    assert found.sighting.until is not None


def test_ends_are_reported_before_the_store_is_written(
    bus: Bus, store: EmbeddedStore, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first lines do not wait for a new store, which takes seconds."""
    written, keep = threading.Event(), Keeper.keep

    def late(self: Keeper, graph: ComputationGraph) -> StoredState:
        written.wait(patient(20))
        return keep(self, graph)

    async def run() -> tuple[list[Event], list[Event]]:
        watching = Watching(store, settings, address=bus.address)
        base = bus.join("/base")
        await base.subscribe("/cmd_vel", "geometry_msgs/Twist")
        monkeypatch.setattr(Keeper, "keep", late)
        async with aclosing(watching.events()) as events:
            before = await _until(events, lambda event: event.event == "end")
            written.set()
            after = await _until(events, _kept)
        return before, after

    before, after = asyncio.run(run())
    assert before[-1].name == "/base subscribes /cmd_vel"
    assert not _told(after, "end")
    assert ("came", "/base") in _told(after, "node")


def test_one_look_is_enough_for_a_snapshot(bus: Bus, store: EmbeddedStore, settings: Settings) -> None:
    """`once` writes the current system to the store."""
    watching = Watching(store, settings, address=bus.address)

    async def run() -> list[Event]:
        base = bus.join("/base")
        await base.advertise("/odom", "nav_msgs/Odometry")
        return await watching.once()

    told = asyncio.run(run())
    assert ("came", "sensingPose") in _told(told, "capability")
    assert store.layout.current() == 1


def test_a_robot_that_is_lost_is_waited_for(bus: Bus, store: EmbeddedStore, settings: Settings) -> None:
    """A lost connection is reported, the graph remains, and watching resumes when the robot is back."""

    async def run() -> list[Event]:
        watching = Watching(store, settings, address=bus.address)
        bus.join("/base")
        async with aclosing(watching.events()) as events:
            await _until(events, _kept)
            for name in [one for one in bus.nodes if one != "/base"]:
                bus.cut(name, "the cable broke")
            return await _until(events, lambda event: event.event == "back")

    told = asyncio.run(run())
    assert [one.event for one in told if one.event in {"lost", "back"}] == ["lost", "back"]
    assert "the cable broke" in next(one.detail for one in told if one.event == "lost")


def test_without_a_robot_it_is_said_how_to_have_one(store: EmbeddedStore, settings: Settings) -> None:
    """No response at the start is an error, with the way to a simulated robot."""

    async def run() -> None:
        watching = Watching(store, settings, address="memory://nobody")
        async for _ in watching.events():
            raise AssertionError

    with pytest.raises(RobotError) as raised:
        asyncio.run(run())
    assert raised.value.code == "KG802"
    assert "kg robot simulate office" in (raised.value.hint or CATALOGUE["KG802"].way_out)


def test_a_store_that_another_process_writes_is_waited_for(bus: Bus, store: EmbeddedStore, settings: Settings) -> None:
    """A lock by another writer is reported once, and the observation is stored afterwards."""

    async def run() -> list[Event]:
        watching = Watching(store, settings, address=bus.address)
        bus.join("/base")
        async with aclosing(watching.events()) as events:
            with store.write("somebody else"):
                told = await _until(events, lambda event: event.event == "busy")
            return told + await _until(events, _kept)

    told = asyncio.run(run())
    assert [one.event for one in told if one.event in {"busy", "kept"}] == ["busy", "kept"]


def test_who_stops_while_the_store_is_written_leaves_it_whole(
    bus: Bus, store: EmbeddedStore, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Watching that is interrupted during a change completes it, and marks the graph as seen last."""
    keep = Keeper.keep
    writing, go = threading.Event(), threading.Event()

    def slowly(self: Keeper, graph: ComputationGraph, *, until: str | None = None) -> StoredState:
        if graph.nodes and until is None:
            with store.write("the watcher"):
                writing.set()
                assert go.wait(patient(10))
        return keep(self, graph, until=until)

    monkeypatch.setattr(Keeper, "keep", slowly)

    async def run() -> None:
        watching = Watching(store, settings, address=bus.address, name="office")
        bus.join("/base")
        stopping = asyncio.ensure_future(_until(watching.events(), _kept))
        assert await asyncio.to_thread(writing.wait, patient(10))
        stopping.cancel()
        await asyncio.gather(stopping, return_exceptions=True)
        ending = asyncio.ensure_future(watching.end())
        await asyncio.sleep(0)
        go.set()
        await ending

    asyncio.run(run())
    with store.read() as snapshot:
        (found,) = systems(snapshot, system_names(snapshot), settings.base)
    assert [one.name for one in found.instances] == ["/base"]
    assert found.sighting is not None
    assert found.sighting.until is not None


def test_states_of_managed_nodes_are_told() -> None:
    """A changed state of a managed node is reported; a node without one is not."""
    before = ComputationGraph(2, (LiveNode("/base", state="inactive"), LiveNode("/laser")))
    after = ComputationGraph(2, (LiveNode("/base", state="active"), LiveNode("/laser")))
    kept = StoredState(None, {})
    told = [list(_differences(one, after, kept, kept)) for one in (before, after)]
    assert [[(one.event, one.name, one.detail) for one in each] for each in told] == [
        [("state", "/base", "active")],
        [],
    ]
