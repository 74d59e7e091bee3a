"""Discovery in a DDS domain: participants, readers and writers, and the nodes that participants announce.

Source: rmw_dds_common. A participant announces the identifiers (GIDs) of the readers and writers of each of its nodes,
as `ParticipantEntitiesInfo` on the topic `ros_discovery_info`; DDS itself announces their topics. Identifiers have 16
bytes since Iron and 24 before, under the same type name. DDS knows only the newer form, so this module reads and writes
bytes. A reader of the newer form also decodes the older one: its 8 extra bytes are zeros, read as an empty list with
trailing bytes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.errors import RobotError
from kg.robot.connection import GraphProblem, LiveEnd, LiveNode
from kg.robot.dds.entities import PREFIX
from kg.robot.ros2.graph import NAMELESS
from kg.robot.ros2.middleware import Neighbourhood
from kg.robot.ros2.names import is_name, replies

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.facts import Qos, Role
    from kg.robot.messages import Types

INFO: Final = "rmw_dds_common/ParticipantEntitiesInfo"
SHORT: Final = 16
"""Bytes of an identifier since Iron."""
LONG: Final = 24
"""Bytes of an identifier in Humble and before."""
_OLD: Final = "rmw_dds_common_before_iron"
_KINDS: Final = {SHORT: INFO, LONG: f"{_OLD}/ParticipantEntitiesInfo"}
_OLD_TYPES: Final = {
    "Gid": "uint8[24] data\n",
    "NodeEntitiesInfo": "string node_namespace\nstring node_name\nGid[] reader_gid_seq\nGid[] writer_gid_seq\n",
    "ParticipantEntitiesInfo": "Gid gid\nNodeEntitiesInfo[] node_entities_info_seq\n",
}


def decode_info(types: Types, content: bytes) -> tuple[Any, int]:
    """Return a decoded announcement and the length of its identifiers: the one that consumes all bytes.

    Raises:
        RobotError: KG810 neither length fits.
    """
    try:
        return types.decode(INFO, content), SHORT
    except RobotError as error:
        try:
            return types.decode(_kind(types, LONG), content), LONG
        except RobotError:
            raise error from None


def encode_info(
    types: Types, gid: bytes, nodes: Iterable[tuple[str, Iterable[bytes], Iterable[bytes]]], length: int
) -> bytes:
    """Return the encoded announcement of a participant and its nodes, each with the GIDs of its readers and writers."""

    def spelt(identity: bytes) -> dict[str, bytes]:
        return {"data": identity.ljust(length, b"\0")}

    announced = []
    for name, readers, writers in nodes:
        namespace, _, own = name.rpartition("/")
        announced.append(
            {
                "node_namespace": namespace or "/",
                "node_name": own,
                "reader_gid_seq": [spelt(one) for one in readers],
                "writer_gid_seq": [spelt(one) for one in writers],
            }
        )
    return types.encode(_kind(types, length), {"gid": spelt(gid), "node_entities_info_seq": announced})


def _kind(types: Types, length: int) -> str:
    if length == LONG and not types.has(_KINDS[LONG]):
        for name, text in _OLD_TYPES.items():
            types.define(f"{_OLD}/{name}", text)
    return _KINDS[length]


Ends: TypeAlias = tuple[frozenset[bytes], ...]
"""The identifiers of the readers and of the writers of a node."""
RosEnd: TypeAlias = "tuple[Role, str, str | None]"
_PARTICIPANT: Final = b"\x00\x00\x01\xc1"
_MOST: Final = 100_000  # maximum number of entities of one kind; beyond any robot


def gid(identifier: Any) -> bytes:
    """Return the 16 bytes of an identifier from its ROS form: a list of characters, of 24 bytes before Iron."""
    return bytes(identifier["data"])[:16]


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A reader or writer of another participant; `end` is None if it is not of a ROS topic or service."""

    participant: bytes
    topic: str
    end: RosEnd | None
    qos: Qos
    handle: int
    type_id: Any = None
    problem: GraphProblem | None = None
    hash: str | None = None
    """The hash of its type, announced since Iron."""


@dataclass(slots=True)
class _Participant:
    address: str
    nodes: dict[str, Ends] = field(default_factory=dict)
    problems: tuple[GraphProblem, ...] = ()
    ours: bool = False
    length: int | None = None
    """The length of its identifiers in bytes."""


class Discovery:
    """The live participants, readers and writers, and their nodes."""

    def __init__(self, own: bytes) -> None:
        self._own = own[:PREFIX]
        self._participants: dict[bytes, _Participant] = {}
        self._early: dict[bytes, tuple[Any, int]] = {}
        self._ends: dict[bytes, Endpoint] = {}
        self._handles: dict[int, bytes] = {}
        self._owners: dict[bytes, str] = {}

    def participant(self, key: bytes, address: str, *, ours: bool = False) -> None:
        """Add a participant; `ours` marks one of another process of kg."""
        if key[:PREFIX] == self._own or len(self._participants) >= _MOST:
            return
        self._participants.setdefault(key[:PREFIX], _Participant(address, ours=ours))
        if key[:PREFIX] in self._early:
            self.announce(*self._early.pop(key[:PREFIX]))

    def end(self, key: bytes, endpoint: Endpoint) -> None:
        """Add a reader or writer."""
        if len(self._ends) < _MOST:
            self._ends[key] = endpoint
            self._handles[endpoint.handle] = key

    def gone(self, key: bytes) -> None:
        """Remove a participant with all its entities, or a reader or writer."""
        endpoint = self._ends.pop(key, None)
        if endpoint is not None:
            self._handles.pop(endpoint.handle, None)
            self._owners.pop(key, None)
        elif key[:PREFIX] in self._participants and key[PREFIX:] == _PARTICIPANT:
            del self._participants[key[:PREFIX]]

    def lengths(self) -> set[int]:
        """Return the lengths of the identifiers of others; participants of kg adapt theirs to others."""
        return {one.length for one in self._participants.values() if one.length is not None and not one.ours}

    def announce(self, value: Any, length: int) -> None:
        """Set the nodes that a participant announces; invalid ones are reported."""
        key = gid(value["gid"])[:PREFIX]
        if key == self._own:
            return
        participant = self._participants.get(key)
        if participant is None:
            if len(self._early) < _MOST:
                self._early[key] = value, length  # its participant arrives in another message
            return
        participant.length = length
        for each in participant.nodes.values():
            for one in (*each[0], *each[1]):
                self._owners.pop(one, None)
        participant.nodes, participant.problems = _nodes(value["node_entities_info_seq"], participant.address)
        for name, each in participant.nodes.items():
            for one in (*each[0], *each[1]):
                if one[:PREFIX] == key:  # nobody can claim the ends of another participant
                    self._owners[one] = name

    def node(self, handle: int) -> str | None:
        """Return the node whose writer has a handle."""
        key = self._handles.get(handle)
        return None if key is None else self._owners.get(key)

    def endpoints(self, name: str) -> Iterator[Endpoint]:
        """Yield the ends of a topic, or those of the requests and responses of a service."""
        return (one for one in self._ends.values() if (one.end and one.end[1] == name) or one.topic == replies(name))

    def hashes(self, name: str) -> Iterator[tuple[str, str]]:
        """Yield the nodes with an end of a name, each with the hash of its type."""
        for key, one in self._ends.items():
            if one.end and one.end[1] == name and one.hash and (owner := self._owners.get(key)):
                yield owner, one.hash

    def neighbourhood(self) -> Neighbourhood:
        """Return the nodes, ends and problems of all but our own participant."""
        nodes = [LiveNode(name, one.address) for one in self._participants.values() for name in one.nodes]
        problems = [problem for one in self._participants.values() for problem in one.problems]
        ends, nameless = [], {}
        for key, endpoint in self._ends.items():
            if endpoint.participant[:PREFIX] == self._own:
                continue
            if endpoint.problem is not None:
                problems.append(endpoint.problem)
            if endpoint.end is None:
                continue
            name = self._owners.get(key)
            if name is None:
                name = f"{NAMELESS}{endpoint.participant[:PREFIX].hex()}"
                nameless[name] = self._participants.get(endpoint.participant[:PREFIX])
            ends.append(LiveEnd(name, *endpoint.end, endpoint.qos))
        nodes += [
            LiveNode(name, one.address if one else None, "no node name reported: a participant without ROS 2")
            for name, one in nameless.items()
        ]
        return Neighbourhood(tuple(nodes), tuple(ends), tuple(problems))


def _nodes(announced: Iterable[Any], address: str) -> tuple[dict[str, Ends], tuple[GraphProblem, ...]]:
    nodes: dict[str, Ends] = {}
    problems = []
    for one in announced:
        name = f"{one['node_namespace'].rstrip('/')}/{one['node_name']}"
        if not is_name(name):
            problems.append(GraphProblem("KG816", address, f"`{name[:80]}` is not a node name"))
        elif name in nodes:
            problems.append(GraphProblem("KG816", address, f"it reports the node `{name}` twice"))
        else:
            nodes[name] = tuple(frozenset(map(gid, one[f"{side}_gid_seq"])) for side in ("reader", "writer"))
    return nodes, tuple(problems)
