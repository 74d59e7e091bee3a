"""Peers that violate the protocol: each is reported with a code, without crash, hang or unbounded growth."""

from __future__ import annotations

import asyncio
import struct
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any
from xmlrpc import client

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import patient

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.ros1 import Master, header
from kg.robot.ros1.names import is_name, is_type, peer
from kg.robot.ros1.xmlrpc import XmlRpcServer, ask, call, xml_read

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.ros1 import Ros1Connection

    Talk = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]


BOMB = b"""<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">
<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]><methodResponse><params><param><value><string>&c;</string></value></param>
</params></methodResponse>"""
STRING_SUM = "992ce8a1687cec8c8bd883ec73ca41d1"
GREETING = {"callerid": "/bad", "type": "std_msgs/String", "md5sum": STRING_SUM, "message_definition": "string data"}


def body(content: bytes, length: int | None = None) -> bytes:
    """Return an HTTP response."""
    return b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\n\r\n" % (len(content) if length is None else length) + content


@asynccontextmanager
async def listening(talk: Talk) -> AsyncIterator[int]:
    """Yield the port of a server that follows a script, and then closes the connection."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            await talk(reader, writer)
        except (OSError, asyncio.IncompleteReadError):
            pass
        finally:
            writer.close()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        server.close()


def saying(content: bytes, *, linger: float = 0) -> Talk:
    """Return a script: read a little, send some bytes, and stay."""

    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.read(1 << 12)
        writer.write(content)
        await writer.drain()
        await asyncio.sleep(linger)

    return talk


@asynccontextmanager
async def system() -> AsyncIterator[tuple[Master, Ros1Connection]]:
    """Yield a master and a node of ours."""
    async with Master() as master:
        connection: Any = await connect(master.address, name="/kg")
        try:
            yield master, connection
        finally:
            await connection.aclose()


async def until(true: Callable[[], bool], seconds: float = 5) -> None:
    """Return when a condition holds."""

    async def wait() -> None:
        while not true():  # noqa: ASYNC110 - a list of problems tells nobody that it grows
            await asyncio.sleep(0.02)

    await asyncio.wait_for(wait(), patient(seconds))


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "KG810"),
        (b"nonsense", "KG810"),
        (b"HTTP/1.1 500 Oops\r\n\r\n", "KG810"),
        (b"HTTP/1.1 200 OK\r\n" + b"X: y\r\n" * 20_000, "KG810"),
        (body(b"<methodResponse>"), "KG810"),
        (body(b"not xml"), "KG810"),
        (body(b"<a/>"), "KG810"),
        (body(b"x", length=10), "KG810"),
        (body(b"x", length=1 << 40), "KG810"),
        (body(b"x").replace(b"1\r\n\r\n", b"-1\r\n\r\n"), "KG810"),
        (body(b"x").replace(b"1\r\n\r\n", b"9" * 5000 + b"\r\n\r\n"), "KG810"),
        (body(BOMB), "KG810"),
        (body(BOMB.decode().encode("utf-16")), "KG810"),
        (body(client.dumps((), methodresponse=None).encode()), "KG810"),
        (body(client.dumps(([],), methodresponse=True).encode()), "KG810"),
        (body(client.dumps((["1", "", 0],), methodresponse=True).encode()), "KG810"),
        (body(client.dumps(([0, "no", 0],), methodresponse=True).encode()), "KG813"),
        (body(client.dumps(client.Fault(1, "no")).encode()), "KG813"),
        (body(client.dumps((1,), methodresponse=True).encode().replace(b">1<", b">" + b"9" * 9000 + b"<")), "KG810"),
    ],
)
def test_answers_that_are_none(content: bytes, code: str) -> None:
    """Invalid XML-RPC is rejected: broken HTTP and XML, document types, wrong lengths, faults."""

    async def scene() -> None:
        async with listening(saying(content)) as port:
            with pytest.raises(RobotError) as caught:
                await ask(f"http://127.0.0.1:{port}/", "getPid", "/kg", seconds=patient(2))
            assert caught.value.code == code

    asyncio.run(scene())


def test_peers_that_do_not_answer() -> None:
    """A slow peer, or one that sends byte by byte, times out; an absent one fails at once."""

    async def drip(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while True:
            writer.write(b"H")
            await asyncio.sleep(0.05)

    async def scene() -> None:
        for talk in (saying(b"", linger=60), drip):
            async with listening(talk) as port:
                with pytest.raises(RobotError) as caught:
                    await call(f"http://127.0.0.1:{port}/", "getPid", "/kg", seconds=0.3)
                assert caught.value.code == "KG803"
        with pytest.raises(RobotError) as caught:
            await call(f"http://127.0.0.1:{port}/", "getPid", "/kg")
        assert caught.value.code == "KG803"

    asyncio.run(scene())


@given(st.binary(max_size=300) | st.text(alphabet="<>/valuestringarydonmbic 019&;", max_size=200).map(str.encode))
@settings(max_examples=200, deadline=None)
def test_any_bytes_are_xml_rpc_or_refused(content: bytes) -> None:
    """Any bytes are a call or a response, or rejected with a code."""
    code = None
    for wrapped in (content, b"<params><param><value>%s</value></param></params>" % content):
        try:
            xml_read(wrapped)
        except RobotError as error:
            code = error.code
        assert code in {None, "KG810", "KG813"}


@given(st.binary(max_size=200))
@settings(max_examples=200, deadline=None)
def test_any_bytes_are_a_header_or_refused(content: bytes) -> None:
    """Any bytes are a connection header or rejected; and a packed header is parsed back."""
    code = None
    try:
        header.unpack(content)
    except RobotError as error:
        code = error.code
    assert code in {None, "KG810"}
    fields = {"topic": content.decode("latin-1"), "md5sum": "*"}
    assert header.unpack(header.pack(fields)[4:]) == fields


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "KG803"),
        (b"\x01\x00", "KG810"),
        (struct.pack("<I", 0xFFFFFFFF), "KG810"),
        (struct.pack("<I", 100) + b"x", "KG810"),
        (struct.pack("<II", 4, 1000), "KG810"),
        (struct.pack("<II", 8, 4) + b"noeq", "KG810"),
        (header.pack({"callerid": "/bad"}), "KG810"),
        (header.pack({**GREETING, "type": "std_msgs String"}), "KG810"),
        (header.pack({**GREETING, "type": "std_msgs/Int32"}), "KG806"),
        (header.pack({**GREETING, "md5sum": "0" * 32}), "KG806"),
        (header.pack({**GREETING, "md5sum": "0" * 32, "message_definition": "int8 data"}), "KG806"),
        (header.pack({**GREETING, "md5sum": "0" * 32, "message_definition": "what?"}), "KG810"),
        (header.pack({"error": "go away"}), "KG806"),
        (header.pack(GREETING) + struct.pack("<I", 0xFFFFFFFF), "KG810"),
        (header.pack(GREETING) + struct.pack("<I", 100) + b"cut", "KG810"),
        (header.pack(GREETING) + header.framed(struct.pack("<I", 0xFFFFFFFF)), "KG810"),
        (header.pack(GREETING) + header.framed(b"\x01\x00\x00\x00\xff"), "KG810"),
    ],
)
def test_publishers_that_break_the_protocol(content: bytes, code: str) -> None:
    """A publisher with a broken header, another checksum, or a truncated or oversized message is reported."""

    async def scene() -> None:
        async with system() as (master, kg), listening(saying(content, linger=0.05)) as port:

            async def answer(_: str, __: list[Any]) -> Any:
                return [1, "", ["TCPROS", "127.0.0.1", port]]

            server = XmlRpcServer(answer)
            uri = f"http://127.0.0.1:{await server.start('127.0.0.1')}/"
            await call(master.uri, "registerPublisher", "/bad", "/topic", "std_msgs/String", uri)
            subscription = await kg.subscribe("/topic", "std_msgs/String")
            reading = asyncio.ensure_future(anext(aiter(subscription)))
            await until(lambda: code in {problem.code for problem in kg.node.problems})
            assert {problem.code for problem in kg.node.problems} <= {code, "KG803"}
            assert code in {problem.code for problem in (await kg.graph()).problems}
            reading.cancel()
            await server.aclose()

    asyncio.run(scene())


@pytest.mark.parametrize(
    "protocol", [0, "TCPROS", ["TCPROS"], ["UDPROS", "h", 1], ["TCPROS", "h", "1"], ["TCPROS", "127.0.0.1", 1 << 20]]
)
def test_publishers_that_offer_nothing(protocol: Any) -> None:
    """A publisher without a transport for its topic is reported."""

    async def scene() -> None:
        async with system() as (master, kg):

            async def answer(_: str, __: list[Any]) -> Any:
                return [1, "", protocol]

            server = XmlRpcServer(answer)
            uri = f"http://127.0.0.1:{await server.start('127.0.0.1')}/"
            await call(master.uri, "registerPublisher", "/bad", "/topic", "std_msgs/String", uri)
            await kg.subscribe("/topic", "std_msgs/String")
            await until(lambda: bool(kg.node.problems))
            assert {problem.code for problem in kg.node.problems} <= {"KG810", "KG803"}
            await server.aclose()

    asyncio.run(scene())


@pytest.mark.parametrize(
    "state",
    [
        0,
        [],
        [[], []],
        [[1], [], []],
        [[["/a", 3]], [], []],
        [[["no name", ["/n"]], ["/ok", ["/n", "../../etc", "", 3]]], [[5, ["/n"]]], [["/s", ["/" + "x" * 9999]]]],
    ],
)
def test_masters_that_tell_nonsense(state: Any) -> None:
    """An invalid state is KG802; invalid names are left out of the graph and reported with KG812."""

    async def answer(method: str, _: list[Any]) -> Any:
        return [1, "", {"getSystemState": state, "getTopicTypes": [["/ok", "no type"]], "getParam": 0}.get(method, [])]

    async def scene() -> None:
        server = XmlRpcServer(answer)
        port = await server.start("127.0.0.1")
        kg = await connect(f"ros1://127.0.0.1:{port}", name="/kg")
        try:
            if state and len(state) == 3 and len(state[0]) == 2:
                graph = await kg.graph()
                assert [end.name for end in graph.ends] == ["/ok"]
                assert "KG812" in {problem.code for problem in graph.problems}
                assert all(len(problem.subject) <= 80 for problem in graph.problems)
            else:
                with pytest.raises(RobotError) as caught:
                    await kg.graph()
                assert caught.value.code == "KG802"
        finally:
            await kg.aclose()
            await server.aclose()

    asyncio.run(scene())


def test_dead_and_mute_nodes() -> None:
    """Dead, silent or invalid nodes are reported, and the graph arrives in time."""

    async def scene() -> None:
        async with (
            system() as (master, kg),
            listening(saying(b"", linger=60)) as mute,
            listening(saying(body(BOMB))) as bad,
        ):
            for name, port in (("/dead", 1), ("/mute", mute), ("/bad", bad)):
                uri = f"http://127.0.0.1:{port}/"
                await call(master.uri, "registerPublisher", name, "/topic", "std_msgs/String", uri)
                await call(master.uri, "registerService", name, f"{name}/s", f"rosrpc://127.0.0.1:{port}", uri)
            graph = await asyncio.wait_for(kg.graph(), patient(5))
            assert {(one.code, one.subject) for one in graph.problems} == {
                ("KG811", "/dead"),
                ("KG811", "/mute"),
                ("KG810", "/bad"),
            }
            assert all(node.problem for node in graph.nodes)
            assert {end.type for end in graph.ends if end.role.channel == "service"} == {None}

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "KG803"),
        (struct.pack("<I", 0xFFFFFFFF), "KG810"),
        (header.pack({"callerid": "/bad"}), "KG803"),
        (header.pack({"error": "no"}), "KG806"),
        (header.pack({"callerid": "/bad"}) + b"\x01", "KG803"),
        (header.pack({"callerid": "/bad"}) + b"\x01" + struct.pack("<I", 0xFFFFFFFF), "KG810"),
        (header.pack({"callerid": "/bad"}) + b"\x01" + header.framed(b"\xff"), "KG810"),
        (header.pack({"callerid": "/bad"}) + b"\x00" + header.framed(b"it \xff failed"), "KG808"),
    ],
)
def test_services_that_break_the_protocol(content: bytes, code: str) -> None:
    """A service with an invalid header or response fails with a code."""

    async def scene() -> None:
        async with system() as (master, kg), listening(saying(content)) as port:
            uris = (f"rosrpc://127.0.0.1:{port}", "http://127.0.0.1:1/")
            await call(master.uri, "registerService", "/bad", "/service", *uris)
            with pytest.raises(RobotError) as caught:
                await kg.call("/service", "std_srvs/Trigger", {}, seconds=patient(2))
            assert caught.value.code == code

    asyncio.run(scene())


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x00",
        struct.pack("<I", 0xFFFFFFFF),
        struct.pack("<I", 0),
        header.pack({"topic": "/none"}),
        header.pack({"service": "/none"}),
        header.pack({"topic": "/out", "md5sum": "0" * 32}),
        header.pack({"topic": "/out", "type": "std_msgs/Int8", "md5sum": "*"}),
        header.pack({"service": "/trigger", "md5sum": "0" * 32}),
        header.pack({"service": "/trigger", "md5sum": "*"}) + struct.pack("<I", 0xFFFFFFFF),
        header.pack({"service": "/trigger", "md5sum": "*"}) + header.framed(b"too much"),
    ],
)
def test_clients_that_break_the_protocol(content: bytes) -> None:
    """An invalid client of our node gets an error, and later clients are served."""

    async def trigger(_: Any) -> Any:
        return {"success": True}

    async def scene() -> None:
        async with system() as (master, kg):
            await kg.advertise("/out", "std_msgs/String")
            await kg.serve("/trigger", "std_srvs/Trigger", trigger)
            _, host, port = await ask(kg.node.uri, "requestTopic", "/x", "/out", [["TCPROS"]])
            reader, writer = await asyncio.open_connection(host, port)
            writer.write(content)
            writer.write_eof()
            await asyncio.wait_for(reader.read(), patient(8))
            writer.close()
            two: Any = await connect(master.address, name="/two")
            assert (await two.call("/trigger", None, {}, seconds=patient(2)))["success"]
            await two.aclose()

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("method", "arguments"),
    [
        ("publisherUpdate", ["/master", "/topic", 3]),
        ("publisherUpdate", ["/master", "/topic", [1, True]]),
        ("publisherUpdate", ["/master", 7, []]),
        ("publisherUpdate", ["/master", "/topic", ["no uri", "http://", "http://127.0.0.1:99999999/"]]),
        ("publisherUpdate", ["/master"]),
        ("requestTopic", ["/x", ["/topic"], {}]),
        ("requestTopic", ["/x", "/none", [["TCPROS"]]]),
        ("requestTopic", ["/x", "/out", [["UDPROS"]]]),
        ("requestTopic", ["/x", "/out", "TCPROS"]),
        ("getPid", []),
        ("getBusInfo", ["/x", 1, 2, 3, 4]),
        ("paramUpdate", ["/master", "/p", 3]),
        ("_on_shutdown", ["/x"]),
        ("__class__", ["/x"]),
        ("", []),
    ],
)
def test_calls_that_do_not_fit(method: str, arguments: list[Any]) -> None:
    """Calls of our node with wrong types, or to unknown methods, get a response; the node continues."""

    async def scene() -> None:
        async with system() as (_, kg):
            await kg.advertise("/out", "std_msgs/String")
            await kg.subscribe("/topic", "std_msgs/String")
            try:
                answer = await call(kg.node.uri, method, *arguments)
            except RobotError as error:
                answer = error.code
            assert answer == "KG813" or answer[0] in {-1, 0, 1}
            assert await ask(kg.node.uri, "getMasterUri", "/x")
            assert not kg.node.lost.done()

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("method", "arguments"),
    [
        ("registerPublisher", ["/n", "no name", "std_msgs/String", "http://h:1/"]),
        ("registerPublisher", ["/n", "/t", "no type", "http://h:1/"]),
        ("registerPublisher", ["/n", "/t", "std_msgs/String", "what"]),
        ("registerPublisher", ["no name", "/t", "std_msgs/String", "http://h:1/"]),
        ("registerPublisher", [1, 2, 3, 4]),
        ("registerService", ["/n", "/s"]),
        ("lookupNode", ["/n", "/none"]),
        ("lookupService", ["/n", ["/none"]]),
        ("getParam", ["/n", "/none"]),
        ("deleteParam", ["/n", "/none/none"]),
        ("searchParam", ["/n", "none"]),
        ("nonsense", []),
        ("__init__", ["/n"]),
    ],
)
def test_calls_that_our_master_refuses(method: str, arguments: list[Any]) -> None:
    """Our master rejects invalid names, types and addresses, and reports unknown ones."""

    async def scene() -> None:
        async with Master() as master:
            with pytest.raises(RobotError) as caught:
                await ask(master.uri, method, *arguments)
            assert caught.value.code == "KG813"
            assert await ask(master.uri, "getSystemState", "/n") == [[], [], []]
            told = await call(master.uri, "system.multicall", [{"methodName": method, "params": arguments}, 3])
            assert len(told) == 2

    asyncio.run(scene())


def test_lost_master() -> None:
    """When the master is gone the connection is lost, has the reason, and rejects later calls."""

    async def scene() -> None:
        master = await Master().__aenter__()
        kg: Any = await connect(master.address, name="/kg")
        publication = await kg.advertise("/out", "std_msgs/String")
        subscription = await kg.subscribe("/in", "std_msgs/String")
        reading = asyncio.ensure_future(anext(aiter(subscription), None))
        await master.__aexit__(None, None, None)
        assert "master" in await asyncio.wait_for(kg.wait_lost(), patient(10))
        assert await reading is None
        with pytest.raises(RobotError) as caught:
            await publication.publish({"data": "x"})
        assert caught.value.code == "KG803"
        await kg.aclose()

    asyncio.run(scene())


def test_master_that_comes_back() -> None:
    """Our node registers again at a restarted master."""

    async def scene() -> None:
        first = await Master().__aenter__()
        port = int(first.address.rpartition(":")[2])
        kg: Any = await connect(first.address, name="/kg")
        await kg.advertise("/out", "std_msgs/String")
        await first.__aexit__(None, None, None)
        async with Master(port=port) as second:
            found: list[Any] = []
            for _ in range(100):
                found = (await ask(second.uri, "getSystemState", "/x"))[0]
                if ["/out", ["/kg"]] in found:
                    break
                await asyncio.sleep(patient(5) / 100)
            assert ["/out", ["/kg"]] in found
            await kg.aclose()

    asyncio.run(scene())


def test_publisher_that_comes_back() -> None:
    """A connection closed by a publisher is reopened while the publisher is listed."""
    count = 0

    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        nonlocal count
        count += 1
        await reader.read(1 << 12)
        writer.write(header.pack(GREETING) + header.framed(header.framed(b"hello")))

    async def scene() -> None:
        async with system() as (master, kg), listening(talk) as port:

            async def answer(_: str, __: list[Any]) -> Any:
                return [1, "", ["TCPROS", "127.0.0.1", port]]

            server = XmlRpcServer(answer)
            uri = f"http://127.0.0.1:{await server.start('127.0.0.1')}/"
            await call(master.uri, "registerPublisher", "/bad", "/topic", "std_msgs/String", uri)
            messages = aiter(await kg.subscribe("/topic", "std_msgs/String"))
            for _ in range(3):
                assert (await asyncio.wait_for(anext(messages), patient(5))).value == {"data": "hello"}
            assert count >= 3
            await server.aclose()

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("address", "code"),
    [
        ("ros1://", "KG801"),
        ("ros1://host:port", "KG801"),
        ("ros1://127.0.0.1:1", "KG802"),
        ("ros1://no.such.host.invalid:11311", "KG802"),
    ],
)
def test_addresses_without_a_master(address: str, code: str) -> None:
    """An invalid address, or one without a listener, is rejected."""
    with pytest.raises(RobotError) as caught:
        asyncio.run(connect(address))
    assert caught.value.code == code


def test_own_name_that_is_none() -> None:
    """Our node cannot have an invalid name."""

    async def scene() -> None:
        async with Master() as master:
            with pytest.raises(RobotError) as caught:
                await connect(master.address, name="/no name")
            assert caught.value.code == "KG812"

    asyncio.run(scene())


def test_own_address_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """If $ROS_HOSTNAME is not a host, our node would be unreachable: KG814."""
    monkeypatch.setenv("ROS_HOSTNAME", "no.such.host.invalid")

    async def scene() -> None:
        async with Master() as master:
            with pytest.raises(RobotError) as caught:
                await connect(master.address)
            assert caught.value.code == "KG814"

    asyncio.run(scene())


@pytest.mark.parametrize("host", ["a" * 100, "a..b", ".", "-" * 64, "ä" * 70, "a b", "a\0b", ""])
def test_hosts_that_are_none(host: str) -> None:
    """A host that resolvers reject is not an address of a node."""
    with pytest.raises(RobotError) as caught:
        asyncio.run(call(f"http://{host}:11311/", "getPid", "/kg"))
    assert caught.value.code == "KG812"


@given(st.text(max_size=30) | st.integers() | st.none())
def test_names_and_addresses(value: Any) -> None:
    """Any text is a valid name, type or address, or is rejected."""
    assert is_name(value) in {True, False}
    assert is_type(value) in {True, False}
    code = None
    try:
        peer(value)
    except RobotError as error:
        code = error.code
    assert code in {None, "KG812"}
