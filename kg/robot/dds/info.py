"""What a participant tells of its nodes: `ParticipantEntitiesInfo` on the topic `ros_discovery_info`.

Source: rmw_dds_common. Identifiers have 16 bytes since Iron and 24 before, under one name of the type. DDS gets to know
the newer form alone, and we read and write bytes. A reader of the newer form takes the older one as well: its 8 more
bytes are zeros, and read as an empty list with something behind it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.robot.messages import Types

__all__ = ["INFO", "LONG", "SHORT", "decode", "encode"]

INFO: Final = "rmw_dds_common/ParticipantEntitiesInfo"
SHORT: Final = 16
"""How many bytes an identifier has since Iron."""
LONG: Final = 24
"""How many it has in Humble and before."""
_OLD: Final = "rmw_dds_common_before_iron"
_KINDS: Final = {SHORT: INFO, LONG: f"{_OLD}/ParticipantEntitiesInfo"}
_OLD_TYPES: Final = {
    "Gid": "uint8[24] data\n",
    "NodeEntitiesInfo": "string node_namespace\nstring node_name\nGid[] reader_gid_seq\nGid[] writer_gid_seq\n",
    "ParticipantEntitiesInfo": "Gid gid\nNodeEntitiesInfo[] node_entities_info_seq\n",
}


def decode(types: Types, content: bytes) -> tuple[Any, int]:
    """Return what a participant tells, and the length of its identifiers: the one that takes up all bytes.

    Raises:
        RobotError: KG810 when neither does.
    """
    try:
        return types.decode(INFO, content), SHORT
    except RobotError as error:
        try:
            return types.decode(_kind(types, LONG), content), LONG
        except RobotError:
            raise error from None


def encode(
    types: Types, gid: bytes, nodes: Iterable[tuple[str, Iterable[bytes], Iterable[bytes]]], length: int
) -> bytes:
    """Return the bytes for a participant and its nodes, each with the identifiers of its readers and writers."""

    def spelt(identity: bytes) -> dict[str, bytes]:
        return {"data": identity.ljust(length, b"\0")}

    told = []
    for name, readers, writers in nodes:
        namespace, _, own = name.rpartition("/")
        told.append(
            {
                "node_namespace": namespace or "/",
                "node_name": own,
                "reader_gid_seq": [spelt(one) for one in readers],
                "writer_gid_seq": [spelt(one) for one in writers],
            }
        )
    return types.encode(_kind(types, length), {"gid": spelt(gid), "node_entities_info_seq": told})


def _kind(types: Types, length: int) -> str:
    if length == LONG and not types.knows(_KINDS[LONG]):
        for name, text in _OLD_TYPES.items():
            types.define(f"{_OLD}/{name}", text)
    return _KINDS[length]
