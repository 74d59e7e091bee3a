"""Systems of Humble, with identifiers of 24 bytes, and of later distributions, with 16 bytes."""

from __future__ import annotations

import asyncio
import struct
import subprocess
import sys
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from patience import patient
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from cyclonedds import _clayer
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from robot.dds.peer import RELIABLE, TOLD, Info, String

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.dds.discovery import LONG, SHORT, decode_info, encode_info
from kg.robot.dds.entities import _ANY, delete
from kg.robot.messages import Types

TYPES = Types(2)
IDENTITIES = st.binary(min_size=16, max_size=16)
NAMES = st.from_regex(r"(/[a-z_][a-z0-9_]{0,8}){1,3}", fullmatch=True)
NODES = st.lists(st.tuples(NAMES, st.lists(IDENTITIES, max_size=4), st.lists(IDENTITIES, max_size=4)), max_size=4)


def text(value: str) -> bytes:
    """Return a string in CDR, padded for the next number."""
    raw = value.encode() + b"\0"
    return struct.pack("<I", len(raw)) + raw + b"\0" * (-len(raw) % 4)


def wire(length: int, gid: bytes, *nodes: tuple[str, str, list[bytes], list[bytes]]) -> bytes:
    """Return the handwritten bytes of a participant: XCDR1, little endian."""
    told = b"\0\1\0\0" + gid.ljust(length, b"\0") + struct.pack("<I", len(nodes))
    for namespace, name, *sides in nodes:
        told += text(namespace) + text(name)
        for side in sides:
            told += struct.pack("<I", len(side)) + b"".join(one.ljust(length, b"\0") for one in side)
    return told


DAEMON = ("/", "_ros2cli_daemon_0_0123456789abcdef0123456789abcdef", [b"r" * 16], [b"w" * 16])
ROBOT = [
    ("/robot", name, [b"r" * 16] * 20, [b"w" * 16] * writers)
    for name, writers in (("sensors", 6), ("mobile_base", 6), ("planner", 7), ("lifey", 7))
]


@pytest.mark.parametrize(
    ("length", "nodes", "size"),
    [(LONG, [DAEMON], 152), (LONG, ROBOT, 2708), (SHORT, [DAEMON], 128), (SHORT, ROBOT, 1852)],
)
def test_bytes_of_both_distributions_are_read(length: int, nodes: list[Any], size: int) -> None:
    """Samples of a process with one node and of one with four are parsed, in the sizes of Humble."""
    content = wire(length, b"g" * 16, *nodes)
    assert len(content) == size
    value, found = decode_info(TYPES, content)
    assert found == length
    told = [(one["node_namespace"], one["node_name"]) for one in value["node_entities_info_seq"]]
    assert told == [one[:2] for one in nodes]


@given(IDENTITIES, NODES, st.sampled_from([SHORT, LONG]))
def test_the_length_is_that_which_takes_up_all_bytes(gid: bytes, nodes: list[Any], length: int) -> None:
    """Bytes written with either length are parsed with that length, and the values are equal."""
    content = encode_info(TYPES, gid, nodes, length)
    value, found = decode_info(TYPES, content)
    assert found == length
    assert bytes(value["gid"]["data"]) == gid.ljust(length, b"\0")
    for told, (name, readers, writers) in zip(value["node_entities_info_seq"], nodes, strict=True):
        assert f"{told['node_namespace'].rstrip('/')}/{told['node_name']}" == name
        for side, ends in (("reader", readers), ("writer", writers)):
            assert [bytes(one["data"])[:16] for one in told[f"{side}_gid_seq"]] == ends


@pytest.mark.parametrize("length", [SHORT, LONG])
def test_what_ends_too_early_is_refused(length: int) -> None:
    """A truncated sample matches neither length."""
    content = wire(length, b"g" * 16, DAEMON)
    for cut in range(1, 100):
        with pytest.raises(RobotError):
            decode_info(TYPES, content[:-cut])


class Process:
    """A participant of Humble with one node, as bytes."""

    def __init__(self, number: int) -> None:
        """Announce a publisher of `/old/talker`."""
        self.participant = DomainParticipant(number)
        topic = Topic(self.participant, "ros_discovery_info", Info)
        self.chatter: Any = DataWriter(self.participant, Topic(self.participant, "rt/chatter", String), qos=RELIABLE)
        self.teller: Any = DataWriter(self.participant, topic, qos=TOLD)
        node: Any = ("/old", "talker", [], [self.chatter.guid.bytes])
        _clayer.ddspy_write(self.teller._ref, wire(LONG, self.participant.guid.bytes, node))


class Listener:
    """A plain DDS participant that reads the announcements of nodes."""

    def __init__(self, number: int) -> None:
        """Start reading."""
        self.participant = DomainParticipant(number)
        self.reader: Any = DataReader(self.participant, Topic(self.participant, "ros_discovery_info", Info), qos=TOLD)

    async def length(self, name: str, wanted: int) -> None:
        """Wait until a node is announced with identifiers of a length."""
        while True:
            found = _clayer.ddspy_take(self.reader._ref, _ANY, 100)
            for content, info in [] if isinstance(found, int) else found:
                if info.valid_data and name.encode() in content and decode_info(TYPES, content)[1] == wanted:
                    return
            await asyncio.sleep(0.01)


def test_humble_is_recognized_and_answered() -> None:
    """Nodes of Humble have their ends without an option and discover ours; after they leave, others discover us."""

    async def scene() -> None:
        with domain() as number:
            listener = Listener(number)
            connection = await connect(f"dds://{number}?settle=1", name="/kg")
            async with asyncio.timeout(patient(20)):
                await listener.length("kg", SHORT)
                old = Process(number)
                async for graph in connection.changes():
                    if [(end.node, end.name) for end in graph.ends] == [("/old/talker", "/chatter")]:
                        break
                await listener.length("kg", LONG)
                delete(old.participant)
                await listener.length("kg", SHORT)
            await connection.aclose()

    asyncio.run(scene())


def test_a_distribution_that_is_named_is_written_at_once() -> None:
    """With `distribution=humble` our node is announced in the form of Humble from the start."""

    async def scene() -> None:
        with domain() as number:
            connection = await connect(f"dds://{number}?distribution=humble&settle=0", name="/kg")
            async with asyncio.timeout(patient(10)):
                await Listener(number).length("kg", LONG)
            await connection.aclose()

    asyncio.run(scene())


OTHER = """
import asyncio, sys
from kg.robot.connecting import connect

async def scene(address):
    connection = await connect(address, name="/other")
    async for graph in connection.changes():
        if [node.name for node in graph.nodes] == ["/kg"]:
            break
    print("seen", flush=True)
    sys.stdin.read()
    await connection.aclose()

asyncio.run(scene(sys.argv[1]))
"""


def test_two_processes_with_different_distributions_find_each_other() -> None:
    """A process configured for Humble and one that is not can read each other's announcements."""

    async def scene() -> None:
        with domain() as number:
            connection = await connect(f"dds://{number}?settle=1", name="/kg")
            command = [sys.executable, "-c", OTHER, f"dds://{number}?distribution=humble&settle=1"]
            pipe = subprocess.PIPE
            other = await asyncio.create_subprocess_exec(*command, stdin=pipe, stdout=pipe)
            assert other.stdout is not None
            try:
                async with asyncio.timeout(patient(20)):
                    assert await other.stdout.readline() == b"seen\n"
                    async for graph in connection.changes():
                        assert not graph.problems
                        if [node.name for node in graph.nodes] == ["/other"]:
                            break
            finally:
                other.kill()
                await other.wait()
                await connection.aclose()

    asyncio.run(scene())
