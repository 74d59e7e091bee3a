"""Robots behind rosbridge."""

from __future__ import annotations

import asyncio
import math
import os
import signal
import subprocess
import sys
from importlib.util import find_spec
from typing import Any

import pytest
from patience import patient

pytest.importorskip("websockets", reason="the extra `ws` is not installed")

from robot.ws.client import first, joined, seen, until
from robot.ws.rosbridge_peer import peer

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect
from kg.robot.messages import Types
from kg.robot.parameters import find, parsed, read, write
from kg.robot.ws.rosbridge import from_json, to_json

both = pytest.mark.parametrize("ros", [1, 2])
OTHERS = """
import sys, roslibpy
ros = roslibpy.Ros(host="127.0.0.1", port=int(sys.argv[1]))
ros.run()
print(sorted(ros.get_topics()), flush=True)
text = roslibpy.Topic(ros, "/text", "std_msgs/String")
def came(message):
    print(message["data"], flush=True)
    roslibpy.Topic(ros, "/answer", "std_msgs/String").publish(roslibpy.Message({"data": "heard"}))
text.subscribe(came)
answer = roslibpy.Service(ros, "/double", "kg_test/Double").call(roslibpy.ServiceRequest({"value": 2.0}))
print(answer["value"], flush=True)
sys.stdin.read()
ros.terminate()
"""


def _double(request: dict[str, Any]) -> dict[str, Any]:
    if request["value"] < 0:
        raise ValueError("negative")
    return {"value": 2 * request["value"]}


@pytest.mark.skipif(find_spec("roslibpy") is None, reason="roslibpy is not installed")
def test_a_client_of_others_understands_the_robot_of_these_tests() -> None:
    """An independent client (roslibpy) lists, receives, publishes and calls: the server speaks rosbridge."""
    with peer() as robot:
        robot.node("/talker", {"/text": "std_msgs/String"})
        robot.services["/double"] = ("kg_test/Double", _double)
        command = [sys.executable, "-c", OTHERS, robot.address.rpartition(":")[2]]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as client:
            assert client.stdout is not None
            assert client.stdout.readline() == "['/rosout', '/text']\n"
            assert client.stdout.readline() == "4.0\n"
            robot.until(lambda: robot.listening == ["/text"])
            robot.publish("/text", {"data": "hello"})
            assert client.stdout.readline() == "hello\n"
            robot.until(lambda: robot.came == [("/answer", {"data": "heard"})])
            client.communicate(timeout=patient(10))


@both
def test_it_says_who_and_where_it_is(ros: int) -> None:
    """The version of ROS follows from the names of types in rosapi."""

    async def scene() -> None:
        with peer(ros) as robot:
            async with joined(robot.address) as one:
                assert (one.name, one.address, one.ros) == ("/kg", robot.address, ros)

    asyncio.run(scene())


@both
def test_messages_arrive_in_order(ros: int) -> None:
    """Messages of the robot arrive in order, with the definition from rosapi."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.node("/odd", {"/odd": "kg_test/Odd"})
            robot.texts[robot.full("kg_test/Odd")] = "float32 oddity\nuint8[] bytes\nbuiltin_interfaces/Time at"
            if ros == 1:
                robot.texts["kg_test/Odd"] = "float32 oddity\nuint8[] bytes\ntime at"
            async with joined(robot.address) as one:
                subscription = await one.subscribe("/odd")
                await until(lambda: robot.listening == ["/odd"])
                at = {"secs": 3, "nsecs": 4} if ros == 1 else {"sec": 3, "nanosec": 4}
                for number in range(5):
                    robot.publish("/odd", {"oddity": number / 2, "bytes": "AP8=", "at": at})
                came = await first(subscription, 5)
                assert [each.value["oddity"] for each in came] == [0.0, 0.5, 1.0, 1.5, 2.0]
                assert came[0].value["bytes"] == b"\x00\xff"
                assert came[0].value["at"] == {"sec": 3, "nanosec": 4}
                await subscription.aclose()
                await until(lambda: robot.listening == [])

    asyncio.run(scene())


@both
def test_messages_are_sent(ros: int) -> None:
    """A topic is advertised with its type and latched, and its messages arrive; an invalid one is KG805."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.node("/base", subscribing={"/cmd_vel": "geometry_msgs/Twist"})
            async with joined(robot.address) as one:
                publication = await one.advertise("/cmd_vel", "geometry_msgs/Twist", latch=True)
                await until(lambda: robot.offered == [("/cmd_vel", robot.full("geometry_msgs/Twist"), True)])
                assert publication.peers == 1
                await publication.publish({"linear": {"x": 0.5}})
                await until(lambda: len(robot.came) == 1)
                zero = {"x": 0.0, "y": 0.0, "z": 0.0}
                assert robot.came == [("/cmd_vel", {"linear": {**zero, "x": 0.5}, "angular": zero})]
                with pytest.raises(RobotError) as misfit:
                    await publication.publish({"linear": "fast"})
                assert misfit.value.code == "KG805"
                await publication.aclose()
                await until(lambda: robot.offered == [])

    asyncio.run(scene())


@both
def test_the_graph_is_that_of_rosapi(ros: int) -> None:
    """Nodes, ends and types are listed, without nodes of the bridge; changes are seen."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.node("/base", {"/odom": "nav_msgs/Odometry"}, {"/cmd_vel": "geometry_msgs/Twist"})
            robot.node("/rosbridge_websocket", {"/cmd_vel": "geometry_msgs/Twist"})
            robot.node("/rosapi")
            async with joined(robot.address) as one:
                graph = await one.graph()
                assert [each.name for each in graph.nodes] == ["/base"]
                assert {(each.node, each.role, each.name, each.type) for each in graph.ends} == {
                    ("/base", Role.PUBLISHES, "/odom", "nav_msgs/Odometry"),
                    ("/base", Role.SUBSCRIBES, "/cmd_vel", "geometry_msgs/Twist"),
                }
                robot.node("/laser", {"/scan": "sensor_msgs/LaserScan"})
                await seen(one, lambda graph: len(graph.nodes) == 2)

    asyncio.run(scene())


@both
def test_a_service_is_called(ros: int) -> None:
    """A call returns the response; its failure is KG808 with its message; an unknown service is KG807."""

    async def scene() -> None:
        with peer(ros) as robot:
            robot.services["/on"] = (
                "std_srvs/SetBool" if ros == 1 else "std_srvs/srv/SetBool",
                lambda request: {"success": request["data"], "message": "done"},
            )
            robot.services["/fails"] = ("std_srvs/Trigger" if ros == 1 else "std_srvs/srv/Trigger", _fails)
            async with joined(robot.address) as one:
                seconds = patient(2)
                answer = await one.call("/on", "std_srvs/SetBool", {"data": True}, seconds=seconds)
                assert answer == {"success": True, "message": "done"}
                for service, kind, code in (
                    ("/fails", None, "KG808"),
                    ("/nobody", None, "KG807"),
                    ("/on", "std_srvs/Empty", "KG806"),
                ):
                    with pytest.raises(RobotError) as failed:
                        await one.call(service, kind, {}, seconds=seconds)
                    assert failed.value.code == code

    asyncio.run(scene())


def _fails(_: dict[str, Any]) -> dict[str, Any]:
    raise ValueError("out of order")


def test_what_differs_is_refused() -> None:
    """A type other than that of rosapi is KG806; an unused topic is KG804, and so is an unknown type."""

    async def scene() -> None:
        with peer() as robot:
            robot.node("/one", {"/text": "std_msgs/String", "/odd": "kg_test/Odd"})
            async with joined(robot.address) as one:
                for topic, kind, code in (
                    ("/text", "std_msgs/Int8", "KG806"),
                    ("/nobody", None, "KG804"),
                    ("/odd", None, "KG804"),
                ):
                    with pytest.raises(RobotError) as refused:
                        await one.subscribe(topic, kind)
                    assert refused.value.code == code

    asyncio.run(scene())


def test_a_message_that_does_not_fit_is_reported() -> None:
    """It is skipped and reported as a problem of the graph; valid ones arrive."""

    async def scene() -> None:
        with peer() as robot:
            robot.node("/one", {"/text": "std_msgs/String"})
            async with joined(robot.address) as one:
                subscription = await one.subscribe("/text")
                await until(lambda: robot.listening == ["/text"])
                robot.publish("/text", {"data": 3})
                robot.publish("/text", {"data": "three"})
                assert (await first(subscription, 1))[0].value == {"data": "three"}
                (problem,) = (await one.graph()).problems
                assert (problem.code, problem.subject) == ("KG810", "/text")

    asyncio.run(scene())


@pytest.mark.parametrize("text", ["nonsense", "[]", '{"op": 3}', '{"topic": "/text"}', '{"op": "publish"}'])
def test_a_server_that_breaks_the_protocol_is_lost(text: str) -> None:
    """An invalid message closes the connection with the reason, or is ignored, and has no other effect."""

    async def scene() -> None:
        with peer() as robot:
            async with joined(robot.address) as one:
                robot.say(text)
                if text != '{"op": 3}':  # an operation of a later version
                    assert "breaks the protocol" in await asyncio.wait_for(one.wait_lost(), patient(5))
                    with pytest.raises(RobotError) as lost:
                        await one.subscribe("/text")
                    assert lost.value.code == "KG803"
                else:
                    assert (await one.graph()).nodes == ()

    asyncio.run(scene())


def test_goals_are_refused() -> None:
    """Goals are KG852 with the reason."""

    async def scene() -> None:
        with peer() as robot:
            async with joined(robot.address) as one:
                with pytest.raises(RobotError) as refused:
                    await one.send_goal("/go", "move_base_msgs/MoveBase", {}, seconds=1)
                assert refused.value.code == "KG852"

    asyncio.run(scene())


def test_a_bridge_without_rosapi_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a description of the bridged system it is KG802, with the program to start."""
    monkeypatch.setattr("kg.robot.ws._OPENING", 0.5)
    with peer() as robot:
        robot.rosapi = False
        with pytest.raises(RobotError) as nobody:
            asyncio.run(connect(robot.address, name="/kg"))
    assert nobody.value.code == "KG802"
    assert "rosapi" in str(nobody.value.hint)


def test_a_bridge_that_ends_is_lost() -> None:
    """Subscriptions end, a pending call fails, and later messages are KG803."""

    async def scene() -> None:
        with peer() as robot:
            robot.node("/one", {"/text": "std_msgs/String"}, {"/cmd_vel": "geometry_msgs/Twist"})
            async with joined(robot.address) as one:
                subscription = await one.subscribe("/text")
                publication = await one.advertise("/cmd_vel", "geometry_msgs/Twist")
                robot.stop()
                assert await asyncio.wait_for(one.wait_lost(), patient(5))
                assert await first(subscription, 1) == []
                assert publication.peers == 0
                with pytest.raises(RobotError) as lost:
                    await publication.publish({})
                assert lost.value.code == "KG803"

    asyncio.run(scene())


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_the_robot_stops_when_kg_dies_or_is_suspended(number: signal.Signals) -> None:
    """The watchdog is another client of the bridge: it sends zero velocity when heartbeats stop."""
    with peer() as robot:
        robot.node("/base", subscribing={"/cmd_vel": "geometry_msgs/Twist"})
        order = ["robot", "do", "drivingAtVelocity", "forward=0.2", "--for", "600", "--robot", robot.address]
        with subprocess.Popen([sys.executable, "-m", "kg", *order], stderr=subprocess.DEVNULL) as kg:
            robot.until(lambda: len(robot.came) > 3 and len(robot.offered) > 1)
            assert robot.came[-1][1]["linear"]["x"] == 0.2
            os.kill(kg.pid, number)
            robot.until(lambda: robot.came[-1][1]["linear"]["x"] == 0.0)
            kg.kill()


@both
@pytest.mark.parametrize("kind", ["sensor_msgs/Image", "sensor_msgs/JointState", "nav_msgs/Path", "tf2_msgs/TFMessage"])
def test_values_come_back_from_json(ros: int, kind: str) -> None:
    """A message, with times, bytes and lists of messages, survives encoding and decoding."""
    types = Types(ros)
    header = {"stamp": {"sec": 5, "nanosec": 6}, "frame_id": "map"}
    values: dict[str, dict[str, Any]] = {
        "sensor_msgs/Image": {"header": header, "data": b"\x01\xff"},
        "sensor_msgs/JointState": {"name": ["a"], "position": [1.5]},
        "nav_msgs/Path": {"poses": [{"header": header}]},
        "tf2_msgs/TFMessage": {"transforms": [{"transform": {"rotation": {"w": 1.0}}}]},
    }
    assert from_json(types, kind, to_json(types, kind, values[kind])) == types.complete(kind, values[kind])


def test_numbers_that_are_not_finite_are_null() -> None:
    """JSON has no NaN: it is null, which is decoded as NaN."""
    types = Types(1)
    told = to_json(types, "std_msgs/Float64", {"data": math.inf})
    assert told == {"data": None}
    assert math.isnan(from_json(types, "std_msgs/Float64", told)["data"])


def test_states_and_parameters_come_over_a_bridge() -> None:
    """The state of a managed node behind a bridge is known, and its parameters are read and set."""
    values: dict[str, Any] = {"speed": {"type": 3, "double_value": 0.5}}

    def set_parameters(request: dict[str, Any]) -> dict[str, Any]:
        values.update({one["name"]: one["value"] for one in request["parameters"]})
        return {"results": [{"successful": True, "reason": ""} for _ in request["parameters"]]}

    async def scene() -> None:
        with peer(2) as robot:
            robot.node("/base", {"/base/transition_event": "lifecycle_msgs/TransitionEvent"})
            for name, kind, answer in (
                (
                    "get_state",
                    "lifecycle_msgs/srv/GetState",
                    lambda _: {"current_state": {"id": 2, "label": "inactive"}},
                ),
                ("list_parameters", "rcl_interfaces/srv/ListParameters", lambda _: {"result": {"names": [*values]}}),
                ("describe_parameters", "rcl_interfaces/srv/DescribeParameters", lambda _: {"descriptors": []}),
                (
                    "get_parameters",
                    "rcl_interfaces/srv/GetParameters",
                    lambda request: {"values": [values[name] for name in request["names"]]},
                ),
                ("set_parameters", "rcl_interfaces/srv/SetParameters", set_parameters),
            ):
                robot.services[f"/base/{name}"] = (kind, answer)
                robot.nodes["/base"]["services"].append(f"/base/{name}")
            async with joined(robot.address) as one:
                assert [node.state for node in (await one.graph()).nodes] == ["inactive"]
                await until(lambda: "/base/transition_event" in robot.listening)
                robot.publish("/base/transition_event", {"goal_state": {"id": 3, "label": "active"}})
                await seen(one, lambda graph: [node.state for node in graph.nodes] == ["active"])
                speed = await find(one, "/base", "speed")
                assert (await write(one, speed, parsed(speed, "1.5"))).value == 1.5

    asyncio.run(scene())


def test_parameters_of_ros_1_do_not_come_over_a_bridge() -> None:
    """The parameter server of ROS 1 is unavailable over a bridge: KG852."""

    async def scene() -> None:
        with peer(1) as robot:
            async with joined(robot.address) as one:
                with pytest.raises(RobotError) as impossible:
                    await read(one)
                assert impossible.value.code == "KG852"

    asyncio.run(scene())
