from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from robot.bag.bags import BEGUN, FORMS, Sent, odometry, write

from kg.errors import RobotError
from kg.facts import Qos, Role
from kg.robot.connecting import connect, not_commanded
from kg.robot.messages import Types
from kg.robot.programs.places import TOPIC, offered

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from kg.robot.connection import Connection, Received, Subscription

every_form = pytest.mark.parametrize("form", FORMS)


@asynccontextmanager
async def played(address: str) -> AsyncIterator[Connection]:
    """Yield a connection to the recording at an address."""
    connection = await connect(address, name="/one")
    try:
        yield connection
    finally:
        await connection.aclose()


async def _all(subscription: Subscription) -> list[Received]:
    return [one async for one in subscription]


def _xs(came: list[Received]) -> list[float]:
    return [one.value["pose"]["pose"]["position"]["x"] for one in came]


@every_form
def test_it_says_who_and_where_it_is(tmp_path: Path, form: str) -> None:
    """A recording has the name of our node, its address, its version of ROS, and the time of its first message."""

    async def scene() -> None:
        address = write(tmp_path, form, odometry(2))
        async with played(address) as one:
            assert (one.name, one.address, one.ros) == ("/one", address, 1 if form == "bag" else 2)
            assert one.clock.now() == BEGUN

    asyncio.run(scene())


@every_form
def test_messages_come_in_order_and_in_their_time(tmp_path: Path, form: str) -> None:
    """All messages arrive with their recorded times, and never early; then the topic ends."""

    async def scene() -> None:
        async with played(write(tmp_path, form, odometry(5, every=0.05))) as one:
            subscription = await one.subscribe("/odom")
            came = []
            async for each in subscription:
                assert one.clock.now() >= each.at
                came.append(each)
            assert _xs(came) == [0.0, 1.0, 2.0, 3.0, 4.0]
            assert [round(each.at - BEGUN, 3) for each in came] == [0.0, 0.05, 0.1, 0.15, 0.2]
            assert {each.node for each in came} == {"/base" if form == "bag" else None}

    asyncio.run(scene())


@every_form
def test_bytes_and_nested_lists_are_read(tmp_path: Path, form: str) -> None:
    """Arrays of bytes are bytes; lists of messages are lists of dicts."""
    value = {"data": b"\x00\x01\xff", "fields": [{"name": "x"}, {"name": "y"}], "width": 3}

    async def scene() -> None:
        async with played(write(tmp_path, form, [Sent("/points", "sensor_msgs/PointCloud2", 0, value)])) as one:
            (came,) = await _all(await one.subscribe("/points", "sensor_msgs/PointCloud2"))
            assert came.value["data"] == b"\x00\x01\xff"
            assert [each["name"] for each in came.value["fields"]] == ["x", "y"]

    asyncio.run(scene())


@every_form
def test_types_are_those_of_the_recording(tmp_path: Path, form: str) -> None:
    """A type unknown to kg is decoded by the definition in the file."""
    types = Types(1 if form == "bag" else 2)
    types.define(
        "kg_test/Odd", "float32 oddity\nkg_test/Part[] parts\n" + "=" * 80 + "\nMSG: kg_test/Part\nint8 number"
    )

    async def scene() -> None:
        sent = Sent("/odd", "kg_test/Odd", 0, {"oddity": 0.5, "parts": [{"number": 3}]})
        async with played(write(tmp_path, form, [sent], types)) as one:
            (came,) = await _all(await one.subscribe("/odd"))
            assert came.value == {"oddity": 0.5, "parts": [{"number": 3}]}

    asyncio.run(scene())


@every_form
def test_the_oldest_are_dropped_and_counted(tmp_path: Path, form: str) -> None:
    """When the queue is full, the oldest messages are dropped and counted."""

    async def scene() -> None:
        async with played(write(tmp_path, form, odometry(8))) as one:
            subscription = await one.subscribe("/odom", queue=3)
            await asyncio.wait_for(one.wait_lost(), patient(2))
            assert _xs(await _all(subscription)) == [5.0, 6.0, 7.0]
            assert subscription.dropped == 5

    asyncio.run(scene())


@every_form
def test_two_topics_are_played_side_by_side(tmp_path: Path, form: str) -> None:
    """Each subscription has its own position in the file."""
    others = [Sent("/text", "std_msgs/String", 0.005 + one / 100, {"data": str(one)}) for one in range(5)]

    async def scene() -> None:
        async with played(write(tmp_path, form, odometry(5) + others)) as one:
            first, second = await one.subscribe("/odom"), await one.subscribe("/text")
            poses, texts = await asyncio.gather(_all(first), _all(second))
            assert _xs(poses) == [0.0, 1.0, 2.0, 3.0, 4.0]
            assert [each.value["data"] for each in texts] == ["0", "1", "2", "3", "4"]

    asyncio.run(scene())


@every_form
def test_a_latched_message_is_kept(tmp_path: Path, form: str) -> None:
    """A late subscriber receives the last latched message; earlier messages of other topics are lost."""
    maps = [Sent("/map", "std_msgs/String", at, {"data": str(at)}, latched=True) for at in (0.0, 0.01, 0.09)]

    async def scene() -> None:
        address = write(tmp_path, form, maps + odometry(10))
        async with played(f"{address}?start=0.05") as one:
            first, second = await one.subscribe("/map"), await one.subscribe("/odom")
            latched, poses = await asyncio.gather(_all(first), _all(second))
            assert [each.value["data"] for each in latched] == ["0.01", "0.09"]
            assert _xs(poses) == [5.0, 6.0, 7.0, 8.0, 9.0]

    asyncio.run(scene())


def test_a_faster_recording_takes_less_time(tmp_path: Path) -> None:
    """A minute at the speed 600 takes a tenth of a second, while the clock advances by a minute."""

    async def scene() -> None:
        async with played(write(tmp_path, "bag", odometry(2, every=60.0)) + "?speed=600") as one:
            begun = asyncio.get_running_loop().time()
            await _all(await one.subscribe("/odom"))
            assert 0.1 <= asyncio.get_running_loop().time() - begun < patient(5)
            assert one.clock.now() >= BEGUN + 60

    asyncio.run(scene())


def test_it_waits_for_the_first_reader(tmp_path: Path) -> None:
    """Time starts with the first subscription, so no message is missed during preparation."""

    async def scene() -> None:
        async with played(write(tmp_path, "mcap", odometry(3))) as one:
            await one.graph()
            assert one.clock.now() == BEGUN
            assert _xs(await _all(await one.subscribe("/odom"))) == [0.0, 1.0, 2.0]

    asyncio.run(scene())


def test_places_leave_it_waiting(tmp_path: Path) -> None:
    """The places of a recorded simulation are not read, because that would start the time."""
    places = Sent(TOPIC, "std_msgs/String", 0, {"data": "kitchen = { x = 1, y = 2 }"}, latched=True)

    async def scene() -> None:
        async with played(write(tmp_path, "mcap", [places, *odometry(1)])) as one:
            assert await offered(one, await one.graph()) == {}
            assert one.clock.now() == BEGUN

    asyncio.run(scene())


@every_form
def test_a_type_that_differs_is_refused(tmp_path: Path, form: str) -> None:
    """A type other than the recorded one is KG806; an unrecorded topic has no type (KG804)."""

    async def scene() -> None:
        async with played(write(tmp_path, form, odometry(1))) as one:
            for topic, kind, code in (("/odom", "std_msgs/String", "KG806"), ("/nobody", None, "KG804")):
                with pytest.raises(RobotError) as refused:
                    await one.subscribe(topic, kind)
                assert refused.value.code == code

    asyncio.run(scene())


def test_a_closed_subscription_ends(tmp_path: Path) -> None:
    """The iteration over a subscription ends when it is closed, even before the end of the recording."""

    async def scene() -> None:
        async with played(write(tmp_path, "mcap", odometry(2, every=3600.0))) as one:
            subscription = await one.subscribe("/odom")
            reading = asyncio.ensure_future(_all(subscription))
            await asyncio.sleep(0)
            await subscription.aclose()
            assert len(await asyncio.wait_for(reading, patient(2))) <= 1

    asyncio.run(scene())


def test_closing_ends_what_is_read(tmp_path: Path) -> None:
    """After closing, subscriptions end, the graph is KG802, a subscription KG803; closing again has no effect."""

    async def scene() -> None:
        one = await connect(write(tmp_path, "bag", odometry(2, every=3600.0)), name="/one")
        reading = asyncio.ensure_future(_all(await one.subscribe("/odom")))
        await one.aclose()
        await one.aclose()
        assert len(await asyncio.wait_for(reading, patient(2))) <= 1
        for code, asked in (("KG802", one.graph()), ("KG803", one.subscribe("/odom"))):
            with pytest.raises(RobotError) as closed:
                await asyncio.ensure_future(asked)
            assert closed.value.code == code

    asyncio.run(scene())


def test_a_bag_of_ros1_tells_who_published(tmp_path: Path) -> None:
    """Nodes and their topics are those of the file; with nothing else known, the nodes are incomplete."""
    messages = [*odometry(4), Sent("/odom", "nav_msgs/Odometry", 0.02, node="/other")]

    async def scene() -> None:
        async with played(write(tmp_path, "bag", messages)) as one:
            graph = await one.graph()
            assert [each.name for each in graph.nodes] == ["/base", "/other"]
            assert all(each.problem for each in graph.nodes)
            assert [(each.node, each.role, each.name, each.type) for each in graph.ends] == [
                ("/base", Role.PUBLISHES, "/odom", "nav_msgs/Odometry"),
                ("/other", Role.PUBLISHES, "/odom", "nav_msgs/Odometry"),
            ]
            assert [(each.name, each.count, round(each.seconds, 3)) for each in graph.recorded] == [("/odom", 5, 0.03)]

    asyncio.run(scene())


@pytest.mark.parametrize("form", ["mcap", "db3"])
def test_a_bag_of_ros2_tells_the_nodes_that_name_themselves(tmp_path: Path, form: str) -> None:
    """Names come from /parameter_events, and from loggers of nodes; child loggers, with a dot, are not nodes."""
    messages = [
        *odometry(2),
        Sent("/parameter_events", "rcl_interfaces/ParameterEvent", 0, {"node": "/robot/planner"}),
        Sent("/rosout", "rcl_interfaces/Log", 0, {"name": "laser"}),
        Sent("/rosout", "rcl_interfaces/Log", 0, {"name": "laser.driver"}),
    ]

    async def scene() -> None:
        async with played(write(tmp_path, form, messages)) as one:
            graph = await one.graph()
            assert [each.name for each in graph.nodes] == ["/_recorded", "/laser", "/robot/planner"]
            (end,) = (each for each in graph.ends if each.name == "/odom")
            assert (end.node, end.type) == ("/_recorded", "nav_msgs/Odometry")
            assert end.qos == Qos("reliable", "volatile", "keep_last", 7, liveliness="automatic")

    asyncio.run(scene())


def test_the_graph_is_told_once(tmp_path: Path) -> None:
    """A recording is constant: its graph is sent once, and nothing more until it is closed."""

    async def scene() -> None:
        one = await connect(write(tmp_path, "mcap", odometry(1)), name="/one")
        following = asyncio.ensure_future(_graphs(one))
        await asyncio.sleep(0)
        await one.aclose()
        assert await asyncio.wait_for(following, patient(2)) == 1

    asyncio.run(scene())


async def _graphs(one: Connection) -> int:
    return len([each async for each in one.changes()])


def test_a_message_that_cannot_be_decoded_is_reported(tmp_path: Path) -> None:
    """Invalid bytes are skipped and reported as a problem of the graph with their topic; other messages arrive."""
    types = Types(1)
    types.define("kg_test/Pair", "int32 one\nint32 two")
    address = write(tmp_path, "bag", [Sent("/pair", "kg_test/Pair", at / 100, {"one": at}) for at in range(3)], types)

    async def scene() -> None:
        longer = Types(1)
        async with played(address) as one:
            unlike: Any = one
            unlike.types = longer  # as if the definition in the file were wrong
            longer.define("kg_test/Pair", "int32 one\nint32 two\nint32 three")
            assert await _all(await one.subscribe("/pair")) == []
            (problem,) = (await one.graph()).problems
            assert (problem.code, problem.subject) == ("KG810", "/pair")

    asyncio.run(scene())


def test_nothing_can_be_commanded(tmp_path: Path) -> None:
    """Every operation that sends is KG851."""

    async def scene() -> None:
        async with played(write(tmp_path, "mcap", odometry(1))) as one:
            asked: list[Any] = [
                one.advertise("/cmd_vel", "geometry_msgs/Twist"),
                one.call("/reset", None, {}, seconds=1),
                one.send_goal("/go", "nav2_msgs/NavigateToPose", {}, seconds=1),
                one.canceller("/go"),
                one.serve("/reset", "std_srvs/Empty", lambda _: asyncio.sleep(0, {})),
                one.serve_action("/go", "nav2_msgs/NavigateToPose", lambda _: asyncio.sleep(0, {})),
            ]
            for each in asked:
                with pytest.raises(RobotError) as refused:
                    await each
                assert refused.value.code == not_commanded("").code == "KG851"

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("query", "told"),
    [("?speed=0", "the speed is 0"), ("?speed=fast", "`fast` is not a number"), ("?rate=2", "an option `rate`")],
)
def test_an_option_that_is_none_is_refused(query: str, told: str) -> None:
    """Invalid parts of an address are KG801, with a suggestion."""
    with pytest.raises(RobotError) as refused:
        asyncio.run(connect(f"bag://drive.bag{query}"))
    assert refused.value.code == "KG801"
    assert told in refused.value.message


@pytest.mark.parametrize("name", ["drive.bag", "drive.mcap", "drive.db3", "drive.txt", "drive"])
@pytest.mark.parametrize("content", [None, b"", b"\x89MCAP0\r\nnonsense", b"#ROSBAG V2.0\n" + b"\xff" * 99])
def test_what_is_no_recording_is_refused(tmp_path: Path, name: str, content: bytes | None) -> None:
    """A missing, empty, broken or unsupported file is KG850, with its name."""
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(RobotError) as refused:
        asyncio.run(connect(f"bag://{tmp_path}/{name}"))
    assert refused.value.code == "KG850"
    assert name in refused.value.message


@pytest.mark.parametrize("form", FORMS)
def test_a_recording_that_was_cut_is_refused_or_read_to_its_end(tmp_path: Path, form: str) -> None:
    """A truncated file is KG850, with no other effect."""
    address = write(tmp_path, form, odometry(200))
    path = tmp_path / ("drive.bag" if form == "bag" else f"drive/drive.{form}")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])

    async def scene() -> None:
        async with played(address) as one:
            await _all(await one.subscribe("/odom"))
            assert [each.code for each in (await one.graph()).problems] == ["KG850"]

    try:
        asyncio.run(scene())
    except RobotError as error:
        assert error.code == "KG850"  # noqa: PT017 - either of two
