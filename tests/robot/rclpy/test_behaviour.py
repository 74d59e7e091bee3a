"""A connection through rclpy passes the suite of every connection, and works with a robot of rclpy."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from robot.connections import Behaviour, System

pytest.importorskip("rclpy", reason="ROS 2 is not installed for this Python")
pytest.importorskip("test_msgs", reason="the package test_msgs of ROS 2 is not installed")

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect
from kg.robot.messages import Types
from kg.robot.parameters import read

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.connection import Accepted, Connection, Value

ENABLE, COUNT = "std_srvs/SetBool", "test_msgs/Fibonacci"
FOREVER = {"order": 10**6}


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> str:
    """Yield the address of a domain visible only to this machine."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    return f"rclpy://{100 + os.getpid() % 100}?settle=1"


OWN_TYPES = {
    "test_the_graph_shows_others_ends",
    "test_a_service_answers",
    "test_a_slow_service_is_not_waited_for",
    "test_a_goal_is_carried_out",
    "test_a_goal_is_cancelled",
    "test_another_node_cancels_a_goal",
    "test_a_newer_goal_takes_over",
    "test_a_goal_that_cannot_be_reached_is_aborted",
    "test_a_goal_is_lost_with_its_server",
    "test_nobody_carries_out_a_goal",
}
"""Tests of the suite with types that no package defines. Their counterparts are below."""


class TestRclpy(Behaviour):
    """The suite of every connection."""

    @pytest.fixture(autouse=True)
    def _compiled(self, request: pytest.FixtureRequest) -> None:
        if request.function.__name__ in OWN_TYPES:
            pytest.skip("rclpy uses compiled types only")

    @pytest.fixture
    def system(self, domain: str) -> System:
        """Yield a domain of our own."""
        return System(2, lambda name: connect(domain, name=name, types=Types(2)), seconds=5)


@contextmanager
def robot(address: str) -> Iterator[subprocess.Popen[str]]:
    """Run the robot of `peer.py` in the domain of an address."""
    number = address.removeprefix("rclpy://").partition("?")[0]
    with subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("peer.py"))],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=os.environ | {"ROS_DOMAIN_ID": number},
    ) as process:  # fmt: skip
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            yield process
        finally:
            process.kill()


def beside_robot(address: str, scene: Any) -> None:
    """Run a scene with the process of the robot and our node."""

    async def run() -> None:
        with robot(address) as process:
            node = await connect(address, name="/kg")
            try:
                await asyncio.wait_for(scene(process, node), patient(30))
            finally:
                await node.aclose()

    asyncio.run(run())


def test_its_graph_is_that_of_the_robot(domain: str) -> None:
    """Node, topics with QoS, service and action of the robot are in the graph, without our own node."""

    async def scene(_: Any, node: Connection) -> None:
        graph = await node.graph()
        ends = {(one.node, one.role, one.name, one.type) for one in graph.ends}
        assert [one.name for one in graph.nodes] == ["/one/robot"]
        assert {
            ("/one/robot", Role.PUBLISHES, "/odom", "nav_msgs/Odometry"),
            ("/one/robot", Role.SUBSCRIBES, "/cmd_vel", "geometry_msgs/Twist"),
            ("/one/robot", Role.SERVICES, "/enable", ENABLE),
            ("/one/robot", Role.ACTION_SERVERS, "/count", COUNT),
        } <= ends
        (odometry,) = [one for one in graph.ends if one.name == "/odom"]
        assert odometry.qos is not None
        assert (odometry.qos.reliability, odometry.qos.durability) == ("best_effort", "volatile")

    beside_robot(domain, scene)


def test_topics_pass_in_both_directions(domain: str) -> None:
    """Best effort and latched messages are received, and a velocity arrives at the robot."""

    async def scene(process: Any, node: Connection) -> None:
        await node.graph()
        for topic, field in (("/odom", "pose"), ("/words", "data")):
            subscription = await node.subscribe(topic)
            value = (await anext(aiter(subscription))).value
            assert value["data"] == "kept" if field == "data" else value["pose"]["pose"]["position"]["x"] == 1.5
            await subscription.aclose()
        publication = await node.advertise("/cmd_vel", "geometry_msgs/Twist")
        while not publication.peers:  # noqa: ASYNC110 - rclpy tells nobody
            await asyncio.sleep(0.01)
        await publication.publish({"linear": {"x": 0.5}})
        assert await asyncio.to_thread(process.stdout.readline) == "speed 0.5\n"

    beside_robot(domain, scene)


def test_a_service_of_the_robot_answers(domain: str) -> None:
    """A call with and without a type returns the response; without a server it is KG807."""

    async def scene(_: Any, node: Connection) -> None:
        call = node.call("/enable", ENABLE, {"data": True}, seconds=patient(5))
        assert await call == {"success": True, "message": "on"}
        assert (await node.call("/enable", None, {"data": False}, seconds=patient(5)))["message"] == "off"
        for nobody in (
            node.call("/nobody", ENABLE, {}, seconds=patient(5)),
            node.send_goal("/nobody", COUNT, {}, seconds=0.5),
        ):
            with pytest.raises(RobotError) as missing:
                await nobody
            assert missing.value.code == "KG807"

    beside_robot(domain, scene)


def test_goals_of_the_robot_end_as_it_says(domain: str) -> None:
    """A goal is executed with feedback, another is aborted, a third is cancelled."""

    async def scene(_: Any, node: Connection) -> None:
        goal = await node.send_goal("/count", COUNT, {"order": 5}, seconds=patient(5))
        told = [one["sequence"] async for one in goal.feedback()]
        assert [list(one) for one in told][-1] == [8]
        assert list((await goal.result())["sequence"]) == [5, 8]
        for order, cancelled in ((-1, False), (10**6, True)):
            goal = await node.send_goal("/count", COUNT, {"order": order}, seconds=patient(5))
            if cancelled:
                await anext(aiter(goal.feedback()))
                await goal.cancel()
            with pytest.raises(RobotError) as ended:
                await goal.result()
            assert ended.value.code == "KG809"

    beside_robot(domain, scene)


def test_parameters_of_the_robot_are_read(domain: str) -> None:
    """Texts and lists are read, although `serialize_message` leaves bytes behind responses."""

    async def scene(_: Any, node: Connection) -> None:
        found, problems = await read(node, "/one/robot")
        values = {one.name: one.value for one in found}
        assert not problems
        assert (values["names"], values["use_sim_time"]) == (["left", "right"], False)

    beside_robot(domain, scene)


def test_the_robot_reads_our_parameters_and_log(domain: str) -> None:
    """A client of rclpy lists the parameters of our node, cannot set the one for its clock, and receives its log."""

    async def scene(process: Any, node: Connection) -> None:
        node.log("info", "it begins")
        process.stdin.write("/kg\n")
        process.stdin.flush()
        told = [await asyncio.to_thread(process.stdout.readline) for _ in range(3)]
        assert told == ["use_sim_time\n", "False\n", "it begins\n"]

    beside_robot(domain, scene)


def test_status_and_feedback_of_an_action_are_topics(domain: str) -> None:
    """Both are read without a type while a goal is executed."""

    async def scene(_: Any, node: Connection) -> None:
        goal = await node.send_goal("/count", COUNT, FOREVER, seconds=patient(5))
        await anext(aiter(goal.feedback()))
        status, feedback = [
            (await anext(aiter(await node.subscribe(f"/count/_action/{name}")))).value
            for name in ("status", "feedback")
        ]
        assert [one["status"] for one in status["status_list"]] == [2]
        assert len(feedback["feedback"]["sequence"]) == 1
        await goal.cancel()
        with pytest.raises(RobotError):
            await goal.result()

    beside_robot(domain, scene)


def test_our_services_and_actions_serve_others(domain: str) -> None:
    """Another node of kg calls a service and sends goals to an action of ours; a failure has no response."""

    async def enable(request: Value) -> Value:
        if not request["data"]:
            raise ValueError("negative")
        return {"success": True, "message": "served"}

    async def count(accepted: Accepted) -> Value:
        for number in range(accepted.goal["order"]):
            if accepted.cancelled:
                break
            await accepted.feedback({"sequence": [number]})
            await asyncio.sleep(0.01)
        return {"sequence": [1, 2]}

    async def scene() -> None:
        one, two = await connect(domain, name="/one"), await connect(domain, name="/two")
        try:
            await one.serve("/enable", ENABLE, enable)
            await one.serve_action("/count", COUNT, count)
            assert (await two.call("/enable", ENABLE, {"data": True}, seconds=patient(5)))["message"] == "served"
            with pytest.raises(RobotError) as silent:
                await two.call("/enable", ENABLE, {"data": False}, seconds=0.5)
            assert silent.value.code == "KG803"
            goal = await two.send_goal("/count", COUNT, {"order": 3}, seconds=patient(5))
            assert [list(one["sequence"]) async for one in goal.feedback()] == [[0], [1], [2]]
            assert list((await goal.result())["sequence"]) == [1, 2]
            goal = await two.send_goal("/count", COUNT, FOREVER, seconds=patient(5))
            await anext(aiter(goal.feedback()))
            await goal.cancel()
            with pytest.raises(RobotError):
                await goal.result()
            goal = await two.send_goal("/count", COUNT, FOREVER, seconds=patient(5))
            await one.aclose()
            with pytest.raises(RobotError) as lost:
                await asyncio.wait_for(goal.result(), patient(20))
            assert lost.value.code == "KG803"
        finally:
            await one.aclose()
            await two.aclose()

    asyncio.run(scene())


def test_a_type_is_learned_from_its_package(domain: str) -> None:
    """An unknown type is read from the installed package, with arrays and nested types."""

    async def scene() -> None:
        node = await connect(domain, name="/one")
        try:
            await node.advertise("/topic", "test_msgs/Nested")
            fields = {one.name: one.type for one in node.types.fields("test_msgs/BasicTypes")}
            assert (fields["float64_value"], fields["bool_value"]) == ("float64", "bool")
            await node.advertise("/texts", "test_msgs/Strings")
            texts = {one.name: one.bound for one in node.types.fields("test_msgs/Strings")}
            assert (texts["string_value"], texts["bounded_string_value"]) == (0, 22)
            with pytest.raises(RobotError) as unknown:
                await node.advertise("/other", "nobody_msgs/Thing")
            assert unknown.value.code == "KG804"
        finally:
            await node.aclose()

    asyncio.run(scene())
