"""Nodes that can be started, with their publishers and subscribers.

The structures are msgspec's, because they are stored as JSON in the store's cache.
"""

from __future__ import annotations

import re
from typing import Final

import msgspec

_TOPIC: Final = re.compile(r"(~/|/)?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)
_PARAMETER: Final = re.compile(r"(~/)?[A-Za-z][\w./]*", re.ASCII)


class Port(msgspec.Struct, array_like=True, frozen=True, gc=False):
    """A publisher or subscriber: `name` as the node passes it to ROS, `type` is `package/Type`.

    `parameter` sets an unknown name. `switches` are those of `kg.facts.Interface`, `arguments` the number of
    command-line arguments that the end requires.
    """

    iri: str
    name: str | None
    type: str
    parameter: str | None = None
    switches: tuple[str, ...] = ()
    arguments: int = 0

    @property
    def topic(self) -> str | None:
        """The name without a leading slash; in the root namespace, relative and absolute names are equal."""
        return self.name.removeprefix("/") if self.name is not None else None

    @property
    def can_be_wired(self) -> bool:
        """Whether a launch file can set its topic: by a remapping, or by the parameter that names it."""
        if self.arguments:
            return False
        if self.name is not None:
            return _TOPIC.fullmatch(self.name) is not None
        return self.parameter is not None and _PARAMETER.fullmatch(self.parameter) is not None


class Part(msgspec.Struct, frozen=True, gc=False):
    """A node type that a launch file can start.

    `family` is the same for variants of a node (the program and the nodelet) and for its copies; `launches` contains
    the numbers of the launch files of the store that start it.
    """

    iri: str
    repository: str
    package: str
    name: str
    kind: str
    ros: int
    path: str
    line: int
    executable: str | None = None
    plugin: str | None = None
    node_name: str | None = None
    deprecated: bool = False
    family: int = 0
    launches: tuple[int, ...] = ()
    inputs: tuple[Port, ...] = ()
    outputs: tuple[Port, ...] = ()

    @property
    def started(self) -> int:
        """Number of launch files of the store that start it."""
        return len(self.launches)

    @property
    def full_name(self) -> str:
        """The full name, `package/node`."""
        return f"{self.package}/{self.name}"


class Network(msgspec.Struct):
    """All parts, sorted by source, package and name."""

    parts: list[Part]

    def published(self) -> set[str]:
        """Return the types that parts publish."""
        return {port.type for part in self.parts for port in part.outputs}

    def subscribed(self) -> set[str]:
        """Return the types that parts subscribe."""
        return {port.type for part in self.parts for port in part.inputs}


def grouped(ports: tuple[Port, ...]) -> list[tuple[str, list[str]]]:
    """Return the types of ends with their known names in the node."""
    by_type: dict[str, list[str]] = {}
    for port in ports:
        by_type.setdefault(port.type, []).extend([port.name] if port.name is not None else [])
    return [(kind, list(dict.fromkeys(names))) for kind, names in by_type.items()]
