"""Independent peers: nodes of rospy and roscpp and the tools of ROS, on rosmaster and on our own master."""

from __future__ import annotations

import asyncio
import subprocess
import tempfile
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from robot.ros1.debian import environment, needs, needs_debian, process, rosmaster, rospy

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import SimulatedClock
from kg.robot.connecting import connect
from kg.robot.ros1 import Master

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Iterator

    from kg.robot.connection import Accepted, ComputationGraph, Connection, Received, Value

pytestmark = [pytest.mark.ros, needs_debian]

PEER = """
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import String
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse
rospy.init_node("peer", disable_signals=True)
latched = rospy.Publisher("/latched", String, latch=True, queue_size=1)
latched.publish("kept")
back = rospy.Publisher("/back", Twist, queue_size=100)
rospy.Subscriber("/there", Twist, back.publish, queue_size=100)
def switch(request):
    if not request.data:
        raise rospy.ServiceException("it does not go off")
    return SetBoolResponse(True, "on")
rospy.Service("/switch", SetBool, switch)
"""
SERVER = """
import rospy, actionlib
from move_base_msgs.msg import MoveBaseAction, MoveBaseFeedback, MoveBaseResult
rospy.init_node("mover", disable_signals=True)
def move(goal):
    feedback = MoveBaseFeedback()
    x = 0.0
    while x < goal.target_pose.pose.position.x:
        if server.is_preempt_requested():
            server.set_preempted(MoveBaseResult(), "asked to stop")
            return
        x += 0.5
        feedback.base_position.pose.position.x = x
        server.publish_feedback(feedback)
        rospy.sleep(0.05)
    if goal.target_pose.pose.position.x < 0:
        server.set_aborted(MoveBaseResult(), "behind the wall")
    else:
        server.set_succeeded(MoveBaseResult())
server = actionlib.SimpleActionServer("/move_base", MoveBaseAction, move, auto_start=False)
server.start()
"""
CLIENT = """
import rospy, actionlib
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import Float64
rospy.init_node("client", disable_signals=True)
client = actionlib.SimpleActionClient("/walk", MoveBaseAction)
heard = rospy.Publisher("/heard", Float64, queue_size=10)
print("ready")
client.wait_for_server()
while not heard.get_num_connections():
    rospy.sleep(0.01)
goal = MoveBaseGoal()
told = []
def hear(one):
    told.append(one.base_position.pose.position.x)
    heard.publish(told[-1])
def send(x):
    told.clear()
    goal.target_pose.pose.position.x = x
    client.send_goal(goal, feedback_cb=hear)
    heard.publish(0)
send(2)
client.wait_for_result(rospy.Duration(20))
print(client.get_state(), told)
send(1e6)
while not told:
    rospy.sleep(0.01)
client.cancel_goal()
client.wait_for_result(rospy.Duration(20))
print(client.get_state())
send(-1)
client.wait_for_result(rospy.Duration(20))
print(client.get_state(), client.get_goal_status_text())
"""
CALLER = """
import rospy
from std_srvs.srv import SetBool
rospy.init_node("caller", disable_signals=True)
print("ready")
rospy.wait_for_service("/ours", 20)
ours = rospy.ServiceProxy("/ours", SetBool, persistent=True)
print(ours(True).message)
print(ours(True).message)
try:
    ours(False)
except rospy.ServiceException as error:
    print(error)
"""


@pytest.fixture(scope="module")
def master() -> Iterator[int]:
    """Return the port of a rosmaster."""
    with rosmaster() as port:
        yield port


@asynccontextmanager
async def joined(port: int, name: str = "/kg") -> AsyncIterator[Connection]:
    """Yield a node of ours on a master."""
    connection = await connect(f"ros1://127.0.0.1:{port}", name=name)
    try:
        yield connection
    finally:
        await connection.aclose()


async def soon(work: Awaitable[Any], seconds: float = 5) -> Any:
    """Return the awaited result, or fail at the time limit."""
    return await asyncio.wait_for(work, patient(seconds))


async def until(true: Callable[[], bool]) -> None:
    """Return when a condition holds."""
    while not true():  # noqa: ASYNC110 - ROS tells nobody how many peers it has
        await asyncio.sleep(0.02)


async def seen(connection: Connection, true: Callable[[ComputationGraph], bool]) -> ComputationGraph:
    """Return the first graph that satisfies a condition."""

    async def wait() -> ComputationGraph:
        async for graph in connection.changes():
            if true(graph):
                return graph
        raise AssertionError

    found: ComputationGraph = await soon(wait())
    return found


async def first(messages: Any) -> Any:
    """Return the first item."""
    return await anext(aiter(messages))


def tool(port: int, *command: str) -> str:
    """Return the output of a tool of ROS."""
    with tempfile.TemporaryDirectory() as home:
        ran = subprocess.run(
            command, env=environment(port, home), capture_output=True, text=True, timeout=patient(20), check=False
        )
    return ran.stdout + ran.stderr


def test_messages_and_services_with_rospy(master: int) -> None:
    """Messages pass in both directions, a latched one is received, a rospy service answers and fails as expected."""

    async def scene() -> None:
        async with joined(master) as kg:
            latched = await kg.subscribe("/latched")
            kept = await soon(first(latched))
            assert (kept.value, kept.latched) == ({"data": "kept"}, True)
            there = await kg.advertise("/there", "geometry_msgs/Twist")
            back = await kg.subscribe("/back", "geometry_msgs/Twist", queue=100)

            async def around() -> Any:
                messages = aiter(back)
                await until(lambda: bool(there.peers and back.connected))  # type: ignore[attr-defined]  # of ROS 1
                for number in range(20):
                    await there.publish({"linear": {"x": float(number)}})
                return [await anext(messages) for _ in range(20)]

            came = await soon(around())
            assert [one.value["linear"]["x"] for one in came] == [float(number) for number in range(20)]
            assert not any(one.latched for one in came)
            answer = await kg.call("/switch", None, {"data": True}, seconds=patient(5))
            assert answer == {"success": True, "message": "on"}
            with pytest.raises(RobotError) as failed:
                await kg.call("/switch", "std_srvs/SetBool", {"data": False}, seconds=patient(5))
            assert failed.value.code == "KG808"
            assert "it does not go off" in failed.value.message
            with pytest.raises(RobotError) as other:
                await kg.call("/switch", "std_srvs/Trigger", {}, seconds=patient(5))
            assert other.value.code == "KG806"

    with rospy(master, PEER):
        asyncio.run(scene())


async def _walk(accepted: Accepted, heard: AsyncIterator[Received]) -> Value:
    x, until = 0.0, accepted.goal["target_pose"]["pose"]["position"]["x"]
    await soon(anext(heard), 20)  # actionlib's client drops messages that arrive before its own call has returned
    if until < 0:
        accepted.abort("behind the wall")
    while x < until and not accepted.cancelled:
        x += 0.5
        await accepted.feedback({"base_position": {"pose": {"position": {"x": x}}}})
        await soon(anext(heard), 20)  # the result, over a connection of its own, may not arrive before it
    return {}


async def _ours(request: Value) -> Value:
    if not request["data"]:
        raise ValueError("it is not on")
    return {"success": True, "message": "from kg"}


def test_actions_of_actionlib(master: int) -> None:
    """The SimpleActionServer of actionlib executes our goals, sends feedback, and ends cancelled ones."""

    async def scene() -> None:
        async with joined(master) as kg:
            kind, seconds = "move_base_msgs/MoveBase", patient(5)
            goal = await kg.send_goal("/move_base", kind, _to(2.0), seconds=seconds)
            told = [one["base_position"]["pose"]["position"]["x"] async for one in goal.feedback()]
            assert told == [0.5, 1.0, 1.5, 2.0]
            assert await soon(goal.result()) == kg.types.complete(f"{kind}_Result", {})
            goal = await kg.send_goal("/move_base", kind, _to(1e6), seconds=seconds)
            await soon(first(goal.feedback()))
            await goal.cancel()
            with pytest.raises(RobotError, match="preempted"):
                await soon(goal.result())
            goal = await kg.send_goal("/move_base", kind, _to(-1.0), seconds=seconds)
            with pytest.raises(RobotError, match="aborted: behind the wall"):
                await soon(goal.result())
            graph = await kg.graph()
            assert [(end.node, end.role, end.type) for end in graph.ends if end.name.startswith("/move_base")] == [
                ("/mover", Role.ACTION_SERVERS, kind)
            ]

    with rospy(master, SERVER):
        asyncio.run(scene())


def _to(x: float) -> Value:
    return {"target_pose": {"header": {"frame_id": "map"}, "pose": {"position": {"x": x}}}}


def test_our_action_and_service_for_rospy(master: int) -> None:
    """The SimpleActionClient of actionlib and a ServiceProxy of rospy use our servers."""

    async def scene() -> tuple[str, str]:
        async with joined(master) as kg:
            heard = aiter(await kg.subscribe("/heard", "std_msgs/Float64", queue=100))
            await kg.serve_action("/walk", "move_base_msgs/MoveBase", lambda accepted: _walk(accepted, heard))
            await kg.serve("/ours", "std_srvs/SetBool", _ours)
            return await asyncio.gather(
                asyncio.to_thread(tool, master, "/usr/bin/python3", "-c", CLIENT),
                asyncio.to_thread(tool, master, "/usr/bin/python3", "-c", CALLER),
            )

    client, caller = asyncio.run(scene())
    # Ignore actionlib's log about responses that arrive before its own call has returned.
    printed = [line for line in client.splitlines() if "not tracking" not in line]
    assert printed == ["ready", "3 [0.5, 1.0, 1.5, 2.0]", "2", "4 behind the wall"]
    assert caller.splitlines()[:3] == ["ready", "from kg", "from kg"]
    assert "it is not on" in caller


@needs("/usr/lib/topic_tools/relay", "/usr/lib/robot_state_publisher/robot_state_publisher")
def test_messages_with_roscpp(master: int) -> None:
    """A relay of roscpp forwards our messages, and the services of its node have their types."""

    async def scene() -> None:
        async with joined(master) as kg:
            sent = await kg.advertise("/in", "std_msgs/String")
            await seen(kg, lambda graph: any(end.name == "/in" for end in graph.ends))

            async def around() -> Any:
                await until(lambda: sent.peers > 0)
                await sent.publish({"data": "a"})  # the relay advertises /out when it knows the type
                await seen(kg, lambda graph: any(end.name == "/out" for end in graph.ends))
                out = await kg.subscribe("/out", "std_msgs/String")
                await until(lambda: bool(out.connected))  # type: ignore[attr-defined]  # of ROS 1
                await sent.publish({"data": "b"})
                told = [(await first(out)).value["data"]]
                if told == ["a"]:  # the relay forwards it to the subscribers of /out at that time
                    told.append((await first(out)).value["data"])
                return told

            assert (await soon(around()))[-1] == "b"
            graph = await kg.graph()
            (relay,) = (node.name for node in graph.nodes if "_relay" in node.name)
            services = {end.name: end.type for end in graph.ends if end.node == relay and end.role is Role.SERVICES}
            assert services[f"{relay}/get_loggers"] == "roscpp/GetLoggers"
            loggers = await kg.call(f"{relay}/get_loggers", None, {}, seconds=patient(5))
            assert {"ros"} <= {one["name"] for one in loggers["loggers"]}

    with process(master, "/usr/lib/topic_tools/relay", "/in", "/out"):
        asyncio.run(scene())


def test_unknown_type_is_learned(master: int) -> None:
    """An unknown type is learned from the header of the publisher, and so is one of another version."""
    code = """
import genpy.dynamic, rospy
kind = genpy.dynamic.generate_dynamic("odd_msgs/Odd", "Header header\\nInner[] inner\\n" + "=" * 80 +
    "\\nMSG: std_msgs/Header\\nuint32 seq\\ntime stamp\\nstring frame_id\\n" + "=" * 80 +
    "\\nMSG: odd_msgs/Inner\\nuint8 KIND = 16 # words\\nfloat32 value\\n")
odd, inner = kind["odd_msgs/Odd"], kind["odd_msgs/Inner"]
rospy.init_node("odd", disable_signals=True)
publisher = rospy.Publisher("/odd", odd, latch=True, queue_size=1)
message = odd()
message.inner = [inner(value=1.5)]
publisher.publish(message)
"""

    async def scene() -> None:
        async with joined(master) as kg:
            assert not kg.types.has("odd_msgs/Odd")
            came = await soon(first(await kg.subscribe("/odd")))
            assert came.value["inner"] == [{"value": 1.5}]
            assert came.node == "/odd"

    with rospy(master, code):
        asyncio.run(scene())


def test_simulated_time(master: int) -> None:
    """With /use_sim_time the clock follows /clock, published by rospy."""
    code = """
import rospy
from rosgraph_msgs.msg import Clock
rospy.init_node("time", disable_signals=True, disable_rostime=True)
publisher = rospy.Publisher("/clock", Clock, latch=True, queue_size=1)
publisher.publish(Clock(rospy.Time(42, 500000000)))
"""

    async def scene() -> None:
        async with joined(master, "/setting") as kg:
            await kg.set_parameter("/use_sim_time", True)  # type: ignore[attr-defined]  # what ROS 1 has
        try:
            async with joined(master) as kg:
                assert isinstance(kg.clock, SimulatedClock)
                if kg.clock.now() == 0:  # rospy was not up yet
                    await soon(kg.clock.sleep(40))
                assert kg.clock.now() == 42.5
        finally:
            async with joined(master, "/setting") as kg:
                await kg.set_parameter("/use_sim_time", False)  # type: ignore[attr-defined]  # the same

    with rospy(master, code):
        asyncio.run(scene())


def test_dead_node_is_reported(master: int) -> None:
    """A killed node still listed by the master is reported as dead, and its ends remain."""

    async def scene() -> None:
        async with joined(master) as kg:
            with rospy(master, PEER.replace('"peer"', '"doomed"')) as peer:
                await seen(kg, lambda graph: _problem(graph, "/doomed") is None and len(graph.nodes) > 0)
                peer.kill()
                peer.wait()
                graph = await seen(kg, lambda graph: _problem(graph, "/doomed") is not None)
            assert ("KG811", "/doomed") in {(one.code, one.subject) for one in graph.problems}
            assert any(end.node == "/doomed" for end in graph.ends)

    asyncio.run(scene())


def _problem(graph: ComputationGraph, node: str) -> str | None:
    return next((one.problem for one in graph.nodes if one.name == node), None)


def test_taken_name(master: int) -> None:
    """A node with the name of a living node gets another name, and the living node continues."""

    async def scene() -> None:
        async with joined(master) as one, joined(master) as two:
            assert one.name == "/kg"
            assert two.name.startswith("/kg_")
            assert {node.name for node in (await two.graph()).nodes} >= {"/kg"}

    asyncio.run(scene())


def test_our_master_for_debian() -> None:
    """A node of rospy, rostopic, rosservice, rosparam and rosnode work with our own master."""

    async def scene() -> dict[str, str]:
        async with Master() as master:
            port = int(master.address.rpartition(":")[2])
            peer = rospy(port, PEER)
            await asyncio.to_thread(peer.__enter__)
            try:
                return {command: await asyncio.to_thread(tool, port, *command.split()) for command in COMMANDS}
            finally:
                await asyncio.to_thread(peer.__exit__, None, None, None)

    told = asyncio.run(scene())
    assert "/back" in told["/usr/bin/rostopic list"].split()
    assert "Type: geometry_msgs/Twist" in told["/usr/bin/rostopic info /there"]
    assert 'data: "kept"' in told["/usr/bin/rostopic echo -n 1 /latched"]
    assert 'message: "on"' in told["/usr/bin/rosservice call /switch true"]
    assert told["/usr/bin/rosservice type /switch"].strip() == "std_srvs/SetBool"
    assert told["/usr/bin/rosparam get /a/b"].strip() == "3"
    assert "b: 3" in told["/usr/bin/rosparam get /a"]
    assert "/a/b" in told["/usr/bin/rosparam list"]
    assert "not" in told["/usr/bin/rosparam get /nothing"]
    assert "/peer" in told["/usr/bin/rosnode list"].split()
    assert "killed" in told["/usr/bin/rosnode kill /peer"]


COMMANDS = (
    "/usr/bin/rostopic list",
    "/usr/bin/rostopic info /there",
    "/usr/bin/rostopic echo -n 1 /latched",
    "/usr/bin/rosservice call /switch true",
    "/usr/bin/rosservice type /switch",
    "/usr/bin/rosparam set /a/b 3",
    "/usr/bin/rosparam get /a/b",
    "/usr/bin/rosparam get /a",
    "/usr/bin/rosparam list",
    "/usr/bin/rosparam get /nothing",
    "/usr/bin/rosnode list",
    "/usr/bin/rosnode kill /peer",
)
