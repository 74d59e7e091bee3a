"""Facts about systems: the computation graph that a launch configuration makes, resolved without running it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from kg.facts.code import DataFile, NodeKind  # noqa: TC001 - results are read by the annotations of `Known`
from kg.facts.launch import LaunchConfiguration, LaunchParameter, Remap, StartedNode, StartKind

if TYPE_CHECKING:
    from kg.facts.code import Interface, Parameter, Qos, Resolution


class MissingType(StrEnum):
    """Why an instance is of no node type of the build."""

    UNKNOWN_PACKAGE = "unknown-package"
    """Its package is not in the build: nothing can be said."""
    UNKNOWN_NODE = "unknown-node"
    """Its package is in the build and has nothing of that name."""
    NO_NODE = "no-node"
    """Its package has a program of that name in which no node was found."""
    NOT_SAID = "not-said"
    """Which package, program or class it starts is not known before run time."""


@dataclass(frozen=True, slots=True, order=True)
class NodeReference:
    """A node type: the source, the package and the name that it has there."""

    repository: str
    package: str
    node: str

    def __str__(self) -> str:
        return f"{self.repository}:{self.package}/{self.node}"


@dataclass(frozen=True, slots=True)
class NodeName:
    """What launch files name a node type by; `mark` is a digest of all that wiring may learn of it."""

    name: str
    kind: NodeKind
    executable: str | None
    plugin: str | None
    aliases: tuple[str, ...]
    mark: str


@dataclass(frozen=True, slots=True)
class Known:
    """What can be started of a package: its node types, in the order of its cached result, and other programs.

    `data` are the files that nodes read when they run.
    """

    nodes: tuple[NodeName, ...] = ()
    programs: tuple[str, ...] = ()
    data: tuple[DataFile, ...] = ()


@dataclass(frozen=True, slots=True)
class InstanceInterface:
    """One end of a topic, service or action of an instance.

    `declared` is what code says of it, `owner` the node type whose code that is: the one that the instance is of, or a
    plugin that it loads. `resolved` is the absolute name after namespaces, parameters and remappings, with a hole for a
    part that is not known, None when nothing is; `resolution` says how it became known. `remap` is what changed the
    name, `parameter` what set it. `qos` is what is in force after overrides.
    """

    declared: Interface
    owner: NodeReference
    resolved: str | None
    resolution: Resolution
    remap: Remap | None = None
    parameter: LaunchParameter | None = None
    qos: Qos | None = None
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class InstanceParameter:
    """A parameter set for an instance: `name` absolute in ROS 1 (`/node/x`) and `/node/x` in ROS 2 as well.

    `declared` is the node's parameter that it sets, None where the node has none of that name as far as is known.
    `similar` are names of parameters of the node that it is likely meant to be.
    """

    name: str
    set: LaunchParameter
    declared: Parameter | None = None
    owner: NodeReference | None = None
    similar: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class InstanceRemap:
    """A remapping of an instance with both names resolved; `used` tells whether it changed the name of an interface.

    `similar` are resolved names of the instance's interfaces that its left side is likely meant to be.
    """

    source: str
    target: str
    remap: Remap
    used: bool
    similar: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class NodeInstance:
    """One start of a node: `name` is absolute.

    `type` is the node type it is of; None with the `reason` (in words) and `missing`, when the build has none.
    `plugins` are the node types of what it loads by parameters; `host` is the name of the instance whose process it
    shares. `complete` tells whether every interface of it is known: the type, all names and all plugins.
    """

    name: str
    namespace: str
    started: StartedNode
    type: NodeReference | None = None
    reason: str | None = None
    plugins: tuple[NodeReference, ...] = ()
    host: str | None = None
    interfaces: tuple[InstanceInterface, ...] = ()
    parameters: tuple[InstanceParameter, ...] = ()
    remaps: tuple[InstanceRemap, ...] = ()
    complete: bool = False
    missing: MissingType | None = None
    since: str | None = None
    """When it was first seen running (ISO 8601, UTC); None where a launch file starts it."""
    similar: tuple[str, ...] = ()
    """Packages of the build that the one it is started from is likely meant to be, where that is not in the build."""

    @property
    def started_type(self) -> str:
        """The package and the name of its node type; else what the launch file starts, `?` for what it does not say.

        Of a node that was seen running and is of no node type of the store, nobody tells what started it.
        """
        if self.type is not None:
            return f"{self.type.package}/{self.type.node}"
        if self.started.kind is StartKind.RUNNING:
            return "(not known)"
        if self.started.kind is StartKind.INNER and self.started.executable is None:
            return self.started.package or "?"
        return f"{self.started.package or '?'}/{self.started.plugin or self.started.executable or '?'}"


@dataclass(frozen=True, slots=True)
class Sighting:
    """How a running system was seen: its address, and from when until when (ISO 8601, UTC), None while it is watched.

    `complete` tells whether it was watched long enough to be known whole.
    """

    address: str
    since: str
    until: str | None = None
    complete: bool = True


@dataclass(frozen=True, slots=True)
class System:
    """A configuration with its instances; `sighting` is of one that was seen running.

    `similar` are pairs of names of one kind (`topic`, `service`, `action`) that are likely meant to be one:
    (kind, name, other name).
    """

    configuration: LaunchConfiguration
    instances: tuple[NodeInstance, ...] = ()
    similar: tuple[tuple[str, str, str], ...] = ()
    shared_parameters: tuple[LaunchParameter, ...] = ()
    """Parameters of ROS 1 that stand below the name of no instance."""
    sighting: Sighting | None = None
