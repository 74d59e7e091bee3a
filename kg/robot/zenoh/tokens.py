"""Liveliness tokens, by which nodes and ends of rmw_zenoh_cpp discover each other, and the keys of their data.

Source: docs/design.md of rmw_zenoh. A token is a key: `@ros2_lv`, domain, session, node, entity, sort (`NN` node, `MP`
publisher, `MS` subscriber, `SS` service, `SC` client), enclave, namespace and name of the node; for an end then topic,
type, hash of the type and quality of service. Slashes within a part are `%`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from kg.facts import Qos, Role
from kg.robot.ros2.names import dds_type, is_name, ros_type

NO_HASH: Final = "TypeHashNotSupported"
"""Placeholder for hashes before Iron."""
_SPACE: Final = "@ros2_lv"
_SORTS: Final = {"MP": Role.PUBLISHES, "MS": Role.SUBSCRIBES, "SS": Role.SERVICES, "SC": Role.CLIENTS}
_NAMES: Final = {role: sort for sort, role in _SORTS.items()}
_NODE_PARTS, _END_PARTS = 9, 13
_RELIABILITY: Final = {"": "reliable", "0": "reliable", "1": "reliable", "2": "best_effort"}
_DURABILITY: Final = {"": "volatile", "0": "volatile", "1": "transient_local", "2": "volatile"}
_HISTORY: Final = {"": "keep_last", "0": "keep_last", "1": "keep_last", "2": "keep_all"}
_LIVELINESS: Final = {"": "automatic", "0": "automatic", "1": "automatic", "3": "manual_by_topic"}
_DEPTH: Final = 42  # the depth of a history whose depth is empty
_LONGEST: Final = 4096


@dataclass(frozen=True, slots=True)
class Token:
    """A node (`role` is None), or an end of one."""

    domain: int
    session: str
    node: str
    role: Role | None = None
    name: str = ""
    kind: str | None = None
    hash: str = NO_HASH
    qos: Qos | None = None
    number: int = 0

    @classmethod
    def read(cls, key: str) -> Token:
        """Return a parsed token; ValueError with the reason if it is invalid."""
        parts = key.split("/")
        if len(key) > _LONGEST or len(parts) not in {_NODE_PARTS, _END_PARTS} or parts[0] != _SPACE:
            raise ValueError(f"it has {len(parts)} parts, not {_NODE_PARTS} or {_END_PARTS}")
        _, domain, session, _, number, sort, _, namespace, name = parts[:_NODE_PARTS]
        if sort not in _SORTS and sort != "NN":
            raise ValueError(f"unknown kind `{sort}`")
        if not (domain.isdecimal() and number.isdecimal()):
            raise ValueError("its domain or its number is missing")
        node = f"{_whole(namespace).rstrip('/')}/{_whole(name)}"
        if not is_name(node):
            raise ValueError(f"`{node[:80]}` is not a node name")
        if sort == "NN":
            return cls(int(domain), session, node, number=int(number))
        topic, kind, digest, qos = parts[_NODE_PARTS:]
        if not is_name(_whole(topic)):
            raise ValueError(f"`{_whole(topic)[:80]}` is not a topic or service name")
        return cls(
            int(domain),
            session,
            node,
            _SORTS[sort],
            _whole(topic),
            ros_type(_whole(kind)),
            _whole(digest),
            read_qos(qos),
            int(number),
        )

    @property
    def key(self) -> str:
        """The token's key."""
        namespace, _, name = self.node.rpartition("/")
        sort = _NAMES[self.role] if self.role else "NN"
        parts = [_SPACE, str(self.domain), self.session, "0", str(self.number), sort, "%"]
        parts += [_part(namespace or "/"), name]
        if self.role and self.kind and self.qos:
            mangled = dds_type(self.kind, service=self.role.channel == "service")
            parts += [_part(self.name), mangled, self.hash, written_qos(self.qos)]
        return "/".join(parts)


def _part(text: str) -> str:
    return text.replace("/", "%")


def _whole(text: str) -> str:
    return text.replace("%", "/")


def pattern(domain: int) -> str:
    """Return the key expression of all tokens of a domain."""
    return f"{_SPACE}/{domain}/**"


def data_key(domain: int, name: str, kind: str, digest: str, *, service: bool = False) -> str:
    """Return the key under which the messages of a topic, or the requests of a service, are exchanged."""
    return f"{domain}/{name.strip('/')}/{dds_type(kind, service=service)}/{digest}"


def written_qos(qos: Qos) -> str:
    """Return a quality of service in the notation of tokens.

    Nothing is left empty, since defaults have changed between versions.
    """
    reliability = "2" if qos.reliability == "best_effort" else "1"
    durability = "1" if qos.durability == "transient_local" else "2"
    history = "2" if qos.history == "keep_all" else "1"
    return f"{reliability}:{durability}:{history},{qos.depth or _DEPTH}:,:,:,,"


def read_qos(text: str) -> Qos:
    """Return the quality of service in a token; ValueError for an invalid text."""
    parts = [part.split(",") for part in text.split(":")]
    if [len(part) for part in parts[:6]] != [1, 1, 2, 2, 2, 3]:
        raise ValueError(f"`{text[:80]}` is not a quality of service")
    (reliability,), (durability,), (history, depth), deadline, lifespan, (liveliness, *lease) = parts[:6]
    return Qos(
        _word(_RELIABILITY, reliability),
        _word(_DURABILITY, durability),
        _word(_HISTORY, history),
        int(_digits(depth) or _DEPTH),
        _seconds(deadline),
        _seconds(lifespan),
        _word(_LIVELINESS, liveliness),
        _seconds(lease),
    )


def _word(words: dict[str, str], text: str) -> str | None:
    _digits(text)
    return words.get(text)


def _digits(text: str) -> str:
    if text and not (text.isascii() and text.isdecimal()):
        raise ValueError(f"`{text[:80]}` is not a number")
    return text


def _seconds(parts: list[str]) -> float | None:
    """Return a duration; zero, and the largest value of rmw, are infinite."""
    seconds, nanoseconds = (int(_digits(part) or 0) for part in parts)
    duration = seconds + nanoseconds / 1e9
    return duration if 0 < duration < (1 << 32) else None
