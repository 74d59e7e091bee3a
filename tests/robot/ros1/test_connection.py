"""A connection on our own master and on Debian's rosmaster: the suite of every middleware."""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from robot.connections import Behaviour, System, types_for_tests
from robot.ros1.debian import needs_debian, rosmaster

from kg.errors import RobotError
from kg.robot.clock import SimulatedClock
from kg.robot.connecting import connect
from kg.robot.ros1 import Master, Ros1Connection
from kg.robot.ros1.actions import ActionServer, Status, topics
from kg.robot.ros1.header import pack
from kg.robot.ros1.xmlrpc import ask

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.connection import Accepted, Connection, Publication, Value


class TestOnOwnMaster(Behaviour):
    """On the master of kg, which listens in the loop of the test."""

    @pytest.fixture
    def system(self) -> System:
        """Return a system whose master starts with its first node."""
        masters: list[Master] = []

        async def join(name: str) -> Connection:
            if not masters:
                masters.append(await Master().__aenter__())
            return await connect(masters[0].address, name=name, types=types_for_tests(1))

        return System(1, join)


@pytest.mark.ros
@needs_debian
class TestOnRosmaster(Behaviour):
    """On the rosmaster of Debian."""

    @pytest.fixture(scope="class")
    def port(self) -> Iterator[int]:
        """Return the port of one rosmaster for all tests of the class."""
        with rosmaster() as port:
            yield port

    @pytest.fixture
    def system(self, port: int) -> System:
        """Return the system of that master."""

        async def join(name: str) -> Connection:
            return await connect(f"ros1://127.0.0.1:{port}", name=name, types=types_for_tests(1))

        return System(1, join, seconds=4)


def test_a_goal_that_nobody_waits_for_is_cancelled() -> None:
    """A goal without a response of the server is cancelled at its time limit, and when its client gives up."""

    async def scene() -> tuple[list[str], list[str]]:
        async with Master() as master:
            one: Any = await connect(master.address, name="/one", types=types_for_tests(1))
            two = await connect(master.address, name="/two", types=types_for_tests(1))
            for part in topics("kg_test/Count"):
                if part.of_server:
                    await two.advertise(f"/count/{part.name}", part.type)
            goals = aiter(await two.subscribe("/count/goal", "kg_test/CountActionGoal"))
            cancels = aiter(await two.subscribe("/count/cancel", "actionlib_msgs/GoalID"))
            one.node.clock = clock = SimulatedClock()  # so a busy machine causes no delay
            late = asyncio.ensure_future(one.send_goal("/count", "kg_test/Count", {"until": 1}, seconds=2))
            sent = [(await asyncio.wait_for(anext(goals), patient(10))).value["goal_id"]["id"]]
            clock.set_time(3.0)
            with pytest.raises(RobotError) as error:
                await late
            assert error.value.code == "KG803"
            given = asyncio.ensure_future(one.send_goal("/count", "kg_test/Count", {"until": 2}, seconds=60))
            sent.append((await asyncio.wait_for(anext(goals), patient(10))).value["goal_id"]["id"])
            given.cancel()
            told = [(await asyncio.wait_for(anext(cancels), patient(10))).value["id"] for _ in range(2)]
            await one.aclose()
            await two.aclose()
        return sent, told

    sent, told = asyncio.run(scene())
    assert sent == told


def test_feedback_right_behind_a_result_is_told() -> None:
    """Feedback just after the result, which has a separate connection, is not lost."""

    async def scene() -> tuple[list[Value], Value]:
        async with Master() as master:
            one = await connect(master.address, name="/one", types=types_for_tests(1))
            two = await connect(master.address, name="/two", types=types_for_tests(1))
            server = {
                part.name: await two.advertise(f"/count/{part.name}", part.type)
                for part in topics("kg_test/Count")
                if part.of_server
            }
            goals = aiter(await two.subscribe("/count/goal", "kg_test/CountActionGoal"))
            await two.subscribe("/count/cancel", "actionlib_msgs/GoalID")
            giving = asyncio.ensure_future(one.send_goal("/count", "kg_test/Count", {"until": 1}, seconds=60))
            identity = (await asyncio.wait_for(anext(goals), patient(10))).value["goal_id"]
            active = {"goal_id": identity, "status": int(Status.ACTIVE)}
            await server["status"].publish({"status_list": [active]})
            goal = await asyncio.wait_for(giving, patient(10))
            await server["result"].publish({"status": {**active, "status": int(Status.SUCCEEDED)}})
            await server["feedback"].publish({"status": active, "feedback": {"now": 1}})
            told = [each async for each in goal.feedback()], await goal.result()
            await one.aclose()
            await two.aclose()
            return told

    assert asyncio.run(scene()) == ([{"now": 1}], {"reached": 0})


def test_a_goal_that_is_cancelled_before_it_comes() -> None:
    """A goal whose cancellation arrives first, over another connection, is not executed."""

    async def scene() -> int:
        async with Master() as master:
            one = await connect(master.address, name="/one", types=types_for_tests(1))
            two: Any = await connect(master.address, name="/two", types=types_for_tests(1))

            async def carry_out(_: Accepted) -> Value:
                raise AssertionError

            server: Any = ActionServer(two, "/count", "kg_test/Count", carry_out)
            await server.open()
            goal = await one.advertise("/count/goal", "kg_test/CountActionGoal")
            cancel = await one.advertise("/count/cancel", "actionlib_msgs/GoalID")
            results = aiter(await one.subscribe("/count/result", "kg_test/CountActionResult"))
            async with asyncio.timeout(patient(10)):
                while not (goal.peers and cancel.peers):  # noqa: ASYNC110 - nothing tells when a peer comes
                    await asyncio.sleep(0.01)
                await cancel.publish({"id": "early"})
                while not server._recalled:  # noqa: ASYNC110 - nor when it has been told
                    await asyncio.sleep(0.01)
                await goal.publish({"goal_id": {"id": "early"}})
                status: int = (await anext(results)).value["status"]["status"]
            await one.aclose()
            await two.aclose()
            return status

    assert asyncio.run(scene()) == Status.RECALLED


def test_goals_that_are_given_at_a_time_are_two() -> None:
    """Two concurrent first goals of an action have different identities, even if the clock does not advance."""

    async def scene() -> None:
        async with Master() as master:
            one = await connect(master.address, name="/one", types=types_for_tests(1))
            two = await connect(master.address, name="/two", types=types_for_tests(1))
            one.node.clock = SimulatedClock()  # type: ignore[attr-defined]  # of ROS 1
            goals = aiter(await two.subscribe("/count/goal", "kg_test/CountActionGoal"))
            for part in topics("kg_test/Count"):
                if part.of_server:
                    await two.advertise(f"/count/{part.name}", part.type)
            await two.subscribe("/count/cancel", "actionlib_msgs/GoalID")
            given = [
                asyncio.ensure_future(one.send_goal("/count", "kg_test/Count", {"until": until}, seconds=60))
                for until in (1, 2)
            ]
            sent = [(await asyncio.wait_for(anext(goals), patient(10))).value for _ in given]
            assert {each["goal"]["until"] for each in sent} == {1, 2}
            assert len({each["goal_id"]["id"] for each in sent}) == 2
            for each in given:
                each.cancel()
            await asyncio.gather(*given, return_exceptions=True)
            await one.aclose()
            await two.aclose()

    asyncio.run(scene())


async def _slow(one: Any, publication: Publication) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Return the connection of a subscriber that has not read anything of `/topic` yet."""
    _, host, port = await ask(one.node.uri, "requestTopic", "/slow", "/topic", [["TCPROS"]])
    reader, writer = await asyncio.open_connection(host, port)
    writer.write(pack({"callerid": "/slow", "topic": "/topic", "type": "std_msgs/String", "md5sum": "*"}))
    async with asyncio.timeout(patient(10)):
        while not publication.peers:  # noqa: ASYNC110 - nothing tells when a peer comes
            await asyncio.sleep(0.01)
    return reader, writer


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux reports what the other machine has confirmed")
def test_messages_in_buffers_of_the_system_are_not_confirmed() -> None:
    """A message that the system still has to send is not confirmed; it is once the subscriber has received it."""

    async def scene() -> None:
        async with Master() as master:
            one: Any = await connect(master.address, name="/one")
            publication = await one.advertise("/topic", "std_msgs/String")
            reader, writer = await _slow(one, publication)
            (link,) = one.node.offers["/topic"].links
            async with asyncio.timeout(patient(30)):
                while publication.confirmed or await asyncio.sleep(0.5, publication.confirmed):
                    await publication.publish({"data": "x" * (1 << 14)})
                assert not link._waiting
                assert not link._writer.transport.get_write_buffer_size()
                while not publication.confirmed:
                    await reader.read(1 << 16)
            writer.close()
            await one.aclose()

    asyncio.run(scene())


def test_what_waits_for_a_slow_subscriber_is_sent_before_the_topic_ends() -> None:
    """The last message of a topic reaches even a slow subscriber with a long send queue."""

    async def scene() -> bytes:
        async with Master() as master:
            one: Any = await connect(master.address, name="/one")
            publication = await one.advertise("/topic", "std_msgs/String")
            reader, writer = await _slow(one, publication)
            (link,) = one.node.offers["/topic"].links
            while not link._waiting:
                await publication.publish({"data": "x" * (1 << 20)})
            await publication.publish({"data": "stand still"})
            await publication.aclose()
            told = await asyncio.wait_for(reader.read(), patient(20))
            writer.close()
            await one.aclose()
            return told

    assert asyncio.run(scene()).endswith(b"stand still")


def test_our_log_is_on_rosout() -> None:
    """Lines of the log have level, name and time of the node."""

    async def scene() -> Value:
        async with Master() as master:
            one, two = await connect(master.address, name="/one"), await connect(master.address, name="/two")
            lines = aiter(await two.subscribe("/rosout", "rosgraph_msgs/Log"))
            asking = asyncio.ensure_future(anext(lines))
            async with asyncio.timeout(patient(10)):
                while not asking.done():
                    one.log("warning", "it slips")
                    await asyncio.sleep(0.05)
            await one.aclose()
            await two.aclose()
            return asking.result().value

    line = asyncio.run(scene())
    assert (line["level"], line["name"], line["msg"]) == (4, "/one", "it slips")
    assert line["header"]["stamp"]["sec"]


def test_a_topic_is_offered_after_an_offer_was_given_up() -> None:
    """An advertised topic is found by subscribers, even if another advertisement was just cancelled."""

    async def scene() -> None:
        async with Master() as master:
            one = await connect(master.address, name="/one", types=types_for_tests(1))
            given_up = asyncio.ensure_future(one.advertise("/topic", "std_msgs/String"))
            await asyncio.sleep(0)
            given_up.cancel()
            publication = await one.advertise("/topic", "std_msgs/String")
            two = await connect(master.address, name="/two", types=types_for_tests(1))
            await two.subscribe("/topic", "std_msgs/String")
            async with asyncio.timeout(patient(10)):
                while not publication.peers:  # noqa: ASYNC110 - nothing tells when a peer comes
                    await asyncio.sleep(0.01)
            await two.aclose()
            await one.aclose()

    asyncio.run(scene())


def test_connecting_can_be_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """A connection cancelled while connecting leaves no node."""
    begun = asyncio.Event()

    async def never(*_: object, **__: object) -> None:
        begun.set()
        await asyncio.sleep(3600)

    monkeypatch.setattr(Ros1Connection, "open_log", never)

    async def scene() -> None:
        async with Master() as master:
            given_up = asyncio.ensure_future(connect(master.address, name="/one", types=types_for_tests(1)))
            await asyncio.wait_for(begun.wait(), patient(10))
            given_up.cancel()
            await asyncio.gather(given_up, return_exceptions=True)
            async with asyncio.timeout(patient(10)):
                while len(asyncio.all_tasks()) > 1:  # noqa: ASYNC110 - the master ends its answers by itself
                    await asyncio.sleep(0.01)

    asyncio.run(scene())
