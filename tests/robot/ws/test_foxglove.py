"""Robots behind a bridge of Foxglove."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from typing import Any

import pytest
from patience import patient

pytest.importorskip("foxglove", reason="foxglove-sdk is not installed")
pytest.importorskip("websockets", reason="the extra `ws` is not installed")

from robot.ws.client import first, joined, seen, until
from robot.ws.foxglove_peer import peer

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect
from kg.robot.parameters import read

both = pytest.mark.parametrize("ros", [1, 2])


@both
def test_it_says_who_and_where_it_is(ros: int) -> None:
    """The version of ROS is that of the encoding supported by the bridge."""

    async def scene() -> None:
        with peer(ros) as robot:
            async with joined(robot.address) as one:
                assert (one.name, one.address, one.ros, one.types.ros) == ("/kg", robot.address, ros, ros)

    asyncio.run(scene())


@both
def test_messages_arrive_in_order(ros: int) -> None:
    """Messages of the robot arrive, complete and in order, with the type given by the bridge."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.types.define("kg_test/Odd", "float32 oddity\nuint8[] bytes")
            robot.channel("/odd", "kg_test/Odd")
            async with joined(robot.address) as one:
                subscription = await one.subscribe("/odd")
                await until(lambda: robot.listening == ["/odd"])
                for number in range(5):
                    robot.publish("/odd", {"oddity": number / 2, "bytes": b"\x00\xff"})
                came = await first(subscription, 5)
                assert [each.value["oddity"] for each in came] == [0.0, 0.5, 1.0, 1.5, 2.0]
                assert came[0].value["bytes"] == b"\x00\xff"
                await subscription.aclose()
                await until(lambda: robot.listening == [])

    asyncio.run(scene())


def test_two_subscriptions_of_one_topic_both_get_it() -> None:
    """The bridge sends a topic once to a client, which passes it to all its subscriptions, even after one is closed."""

    async def scene() -> None:
        with peer() as robot:
            robot.channel("/text", "std_msgs/String")
            async with joined(robot.address) as one:
                two, three = await one.subscribe("/text"), await one.subscribe("/text")
                await until(lambda: robot.listening == ["/text"])
                robot.publish("/text", {"data": "a"})
                assert [(await first(each, 1))[0].value["data"] for each in (two, three)] == ["a", "a"]
                await two.aclose()
                robot.publish("/text", {"data": "b"})
                assert (await first(three, 1))[0].value["data"] == "b"

    asyncio.run(scene())


def test_a_publisher_that_comes_again_is_heard_again() -> None:
    """A restarted node is another channel, which is subscribed to, too."""

    async def scene() -> None:
        with peer() as robot:
            robot.channel("/text", "std_msgs/String")
            async with joined(robot.address) as one:
                subscription = await one.subscribe("/text")
                await until(lambda: robot.listening == ["/text"])
                robot.close_channel("/text")
                await until(lambda: robot.listening == [])
                robot.channel("/text", "std_msgs/String")
                await until(lambda: robot.listening == ["/text"])
                robot.publish("/text", {"data": "again"})
                assert (await first(subscription, 1))[0].value["data"] == "again"

    asyncio.run(scene())


@both
def test_messages_are_sent(ros: int) -> None:
    """A published message arrives at the robot, in the encoding of its ROS; an invalid one is KG805."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.channel("/cmd_vel", "geometry_msgs/Twist")
            robot.graph({}, {"/cmd_vel": ["/base", "/mux"]})
            async with joined(robot.address) as one:
                publication = await one.advertise("/cmd_vel", "geometry_msgs/Twist", latch=True)
                await until(lambda: bool(robot.offered))
                assert publication.peers == 2
                await publication.publish({"linear": {"x": 0.5}})
                await until(lambda: len(robot.came) == 1)
                topic, value = robot.came[0]
                assert (topic, value["linear"]["x"]) == ("/cmd_vel", 0.5)
                with pytest.raises(RobotError) as misfit:
                    await publication.publish({"linear": "fast"})
                assert misfit.value.code == "KG805"
                await publication.aclose()
                await until(lambda: not robot.offered)

    asyncio.run(scene())


@both
def test_the_graph_is_that_of_the_bridge(ros: int) -> None:
    """Nodes, their ends and types are listed, without the bridge's own node; changes are seen."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.channel("/odom", "nav_msgs/Odometry")
            robot.channel("/cmd_vel", "geometry_msgs/Twist")
            robot.graph({"/odom": ["/base"]}, {"/cmd_vel": ["/base"], "/odom": ["/foxglove_bridge"]})
            async with joined(robot.address) as one:
                graph = await one.graph()
                assert [each.name for each in graph.nodes] == ["/base"]
                assert {(each.node, each.role, each.name, each.type) for each in graph.ends} == {
                    ("/base", Role.PUBLISHES, "/odom", "nav_msgs/Odometry"),
                    ("/base", Role.SUBSCRIBES, "/cmd_vel", "geometry_msgs/Twist"),
                }
                robot.graph({"/odom": ["/base"]}, {})
                await seen(one, lambda graph: len(graph.ends) == 1)

    asyncio.run(scene())


def test_a_bridge_that_tells_no_graph_has_one_node() -> None:
    """If the bridge sends no nodes, a single one represents all, and is marked so."""

    async def scene() -> None:
        with peer(tells=False) as robot:
            robot.channel("/odom", "nav_msgs/Odometry")
            async with joined(robot.address) as one:
                (node,) = (await one.graph()).nodes
                assert node.name == "/_bridged"
                assert node.problem

    asyncio.run(scene())


@both
def test_a_service_is_called(ros: int) -> None:
    """A call returns the response; its failure is KG808 with its message; an unknown service is KG807."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.types.define("kg_test/Double_Request", "float64 value")
            robot.types.define("kg_test/Double_Response", "float64 value")
            robot.serve("/double", "kg_test/Double", _double)
            async with joined(robot.address) as one:
                seconds = patient(2)
                assert await one.call("/double", "kg_test/Double", {"value": 2.0}, seconds=seconds) == {"value": 4.0}
                with pytest.raises(RobotError) as failed:
                    await one.call("/double", None, {"value": -1.0}, seconds=seconds)
                assert failed.value.code == "KG808"
                assert "negative" in failed.value.message
                for service, kind, code in (("/nobody", None, "KG807"), ("/double", "std_srvs/Empty", "KG806")):
                    with pytest.raises(RobotError) as refused:
                        await one.call(service, kind, {}, seconds=seconds)
                    assert refused.value.code == code

    asyncio.run(scene())


def _double(request: dict[str, Any]) -> dict[str, Any]:
    if request["value"] < 0:
        raise ValueError("negative")
    return {"value": 2 * request["value"]}


def test_what_differs_is_refused() -> None:
    """A type other than the bridge's is KG806; an unadvertised topic has none (KG804)."""

    async def scene() -> None:
        with peer() as robot:
            robot.channel("/text", "std_msgs/String")
            async with joined(robot.address) as one:
                for topic, kind, code in (("/text", "std_msgs/Int8", "KG806"), ("/nobody", None, "KG804")):
                    with pytest.raises(RobotError) as refused:
                        await one.subscribe(topic, kind)
                    assert refused.value.code == code

    asyncio.run(scene())


def test_what_a_bridge_cannot_do_is_refused() -> None:
    """Goals and services of ours are KG852, and so is publishing if the bridge accepts no messages."""

    async def scene() -> None:
        with peer(takes=False) as robot:
            async with joined(robot.address) as one:
                asked: list[Any] = [
                    one.advertise("/cmd_vel", "geometry_msgs/Twist"),
                    one.send_goal("/go", "nav2_msgs/NavigateToPose", {}, seconds=1),
                    one.serve("/reset", "std_srvs/Empty", lambda _: asyncio.sleep(0, {})),
                ]
                for each in asked:
                    with pytest.raises(RobotError) as refused:
                        await each
                    assert refused.value.code == "KG852"

    asyncio.run(scene())


def test_a_bridge_that_ends_is_lost() -> None:
    """Subscriptions end, waiters get the reason, and later messages are KG803."""

    async def scene() -> None:
        with peer() as robot:
            robot.channel("/text", "std_msgs/String")
            async with joined(robot.address) as one:
                subscription = await one.subscribe("/text")
                publication = await one.advertise("/cmd_vel", "geometry_msgs/Twist")
                await asyncio.to_thread(robot.server.stop)
                assert await asyncio.wait_for(one.wait_lost(), patient(5))
                assert await first(subscription, 1) == []
                with pytest.raises(RobotError) as lost:
                    await publication.publish({})
                assert lost.value.code == "KG803"

    asyncio.run(scene())


def test_nobody_is_there() -> None:
    """An address without a listener is KG802."""
    with peer() as robot:
        address = robot.address
    with pytest.raises(RobotError) as nobody:
        asyncio.run(connect(address, name="/kg"))
    assert nobody.value.code == "KG802"


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_the_robot_stops_when_kg_dies_or_is_suspended(number: signal.Signals) -> None:
    """The watchdog is another client of the bridge: it sends zero velocity when heartbeats stop."""
    with peer() as robot:
        robot.channel("/cmd_vel", "geometry_msgs/Twist")
        robot.graph({}, {"/cmd_vel": ["/base"]})
        order = ["robot", "do", "drivingAtVelocity", "forward=0.2", "--for", "600", "--robot", robot.address]
        with subprocess.Popen([sys.executable, "-m", "kg", *order], stderr=subprocess.DEVNULL) as kg:
            robot.until(lambda: len(robot.came) > 3 and len(robot.offered) > 1)
            assert robot.came[-1][1]["linear"]["x"] == 0.2
            os.kill(kg.pid, number)
            robot.until(lambda: robot.came[-1][1]["linear"]["x"] == 0.0)
            kg.kill()


def test_states_come_over_a_bridge() -> None:
    """The state of a managed node behind a bridge is known, and each change of it."""
    event, service = "/base/transition_event", "/base/get_state"

    async def scene() -> None:
        with peer(2) as robot:
            robot.channel(event, "lifecycle_msgs/TransitionEvent")
            robot.serve(service, "lifecycle_msgs/GetState", lambda _: {"current_state": {"id": 2}})
            async with joined(robot.address) as one:
                robot.graph({event: ["/base"]}, {}, {service: ["/base"]})
                await seen(one, lambda graph: [node.state for node in graph.nodes] == ["inactive"])
                await until(lambda: robot.listening == [event])
                robot.publish(event, {"goal_state": {"id": 3}})
                await seen(one, lambda graph: [node.state for node in graph.nodes] == ["active"])

    asyncio.run(scene())


def test_parameters_are_read_where_a_bridge_tells_no_nodes() -> None:
    """The services of a node contain its name, even if the bridge does not list nodes."""
    values = [{"type": 3, "double_value": 0.5}]

    async def scene() -> None:
        with peer(2, tells=False) as robot:
            for name, kind, answer in (
                ("list_parameters", "ListParameters", lambda _: {"result": {"names": ["speed"]}}),
                ("get_parameters", "GetParameters", lambda _: {"values": values}),
                ("describe_parameters", "DescribeParameters", lambda _: {"descriptors": []}),
            ):
                robot.serve(f"/base/{name}", f"rcl_interfaces/{kind}", answer)
            async with joined(robot.address) as one:
                ((speed,), problems) = await read(one)
                assert (speed.node, speed.name, speed.value, problems) == ("/base", "speed", 0.5, [])

    asyncio.run(scene())
