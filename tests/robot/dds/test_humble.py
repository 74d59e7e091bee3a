"""Systems of Humble, whose identifiers have 24 bytes."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from patience import patient
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl import types as idl
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from robot.dds.peer import RELIABLE, TOLD, String

from kg.robot.connecting import connect

_ARRAY: Any = idl.array
_SEQUENCE: Any = idl.sequence


def _made(name: str, fields: dict[str, Any]) -> Any:
    return make_idl_struct(name, f"rmw_dds_common.msg.dds_.{name}_", fields)


_GID = _made("Gid", {"data": _ARRAY[idl.uint8, 24]})
_NODE = _made(
    "NodeEntitiesInfo",
    {"node_namespace": str, "node_name": str, "reader_gid_seq": _SEQUENCE[_GID], "writer_gid_seq": _SEQUENCE[_GID]},
)
_INFO = _made("ParticipantEntitiesInfo", {"gid": _GID, "node_entities_info_seq": _SEQUENCE[_NODE]})


def _gid(identity: bytes) -> Any:
    return _GID(list(identity.ljust(24, b"\0")))


def test_nodes_of_humble_are_found() -> None:
    """With `distribution=humble` nodes of Humble have their ends, and they find ours."""

    async def scene() -> None:
        with domain() as number:
            participant = DomainParticipant(number)
            topic = Topic(participant, "ros_discovery_info", _INFO)
            writer: Any = DataWriter(participant, Topic(participant, "rt/chatter", String), qos=RELIABLE)
            teller, heard = DataWriter(participant, topic, qos=TOLD), DataReader(participant, topic, qos=TOLD)
            node = _NODE("/old", "talker", [], [_gid(writer.guid.bytes)])
            teller.write(_INFO(_gid(participant.guid.bytes), [node]))
            connection = await connect(f"dds://{number}?distribution=humble&settle=1", name="/kg")
            names: set[str] = set()
            async with asyncio.timeout(patient(10)):
                async for graph in connection.changes():
                    if [(end.node, end.name) for end in graph.ends] == [("/old/talker", "/chatter")]:
                        break
                while names != {"talker", "kg"}:
                    names |= {one.node_entities_info_seq[0].node_name for one in heard.take(10)}
                    await asyncio.sleep(0.01)
            await connection.aclose()

    asyncio.run(scene())
