"""Facts about systems: the computation graph of a launch configuration, resolved without running it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from kg.facts.code import DataFile, NodeKind  # noqa: TC001 - results are read by the annotations of `Known`
from kg.facts.launch import LaunchConfiguration, LaunchParameter, Remap, StartedNode, StartKind

if TYPE_CHECKING:
    from kg.facts.code import Interface, Parameter, Qos, Resolution


class MissingType(StrEnum):
    """Why an instance has no node type in the build."""

    UNKNOWN_PACKAGE = "unknown-package"
    """Its package is not in the build."""
    UNKNOWN_NODE = "unknown-node"
    """Its package is in the build, but does not contain that name."""
    NO_NODE = "no-node"
    """Its package contains a program of that name, in which no node was found."""
    NOT_SAID = "not-said"
    """Its package, program or class is only known at run time."""


@dataclass(frozen=True, slots=True, order=True)
class NodeReference:
    """A node type by source, package and name."""

    repository: str
    package: str
    node: str

    def __str__(self) -> str:
        return f"{self.repository}:{self.package}/{self.node}"


@dataclass(frozen=True, slots=True)
class NodeName:
    """The name of a node type in launch files; `mark` is a digest of the facts that wiring may use."""

    name: str
    kind: NodeKind
    executable: str | None
    plugin: str | None
    aliases: tuple[str, ...]
    mark: str


@dataclass(frozen=True, slots=True)
class Known:
    """What can be started from a package: its node types, in the order of its cached result, and other programs.

    `data` contains the files that nodes read at run time.
    """

    nodes: tuple[NodeName, ...] = ()
    programs: tuple[str, ...] = ()
    data: tuple[DataFile, ...] = ()


@dataclass(frozen=True, slots=True)
class InstanceInterface:
    """One end of a topic, service or action of an instance.

    `declared` is the declaration in code, `owner` the node type that declares it: that of the instance, or a plugin
    that it loads. `resolved` is the absolute name after namespaces, parameters and remappings, with holes for unknown
    parts, None if all is unknown; `resolution` is how it was resolved. `remap` is the remapping that changed the name,
    `parameter` the parameter that set it. `qos` is the effective one after overrides. `switches` are those of
    `declared` that decide whether the instance has the end, and that depend on unknown values.
    """

    declared: Interface
    owner: NodeReference
    resolved: str | None
    resolution: Resolution
    remap: Remap | None = None
    parameter: LaunchParameter | None = None
    qos: Qos | None = None
    reason: str | None = None
    switches: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class InstanceParameter:
    """A parameter set for an instance: `name` is absolute in ROS 1 (`/node/x`), and `/node/x` in ROS 2 as well.

    `declared` is the node's parameter that it sets, None if the node has none of that name as far as known. `similar`
    contains parameters of the node as suggestions.
    """

    name: str
    set: LaunchParameter
    declared: Parameter | None = None
    owner: NodeReference | None = None
    similar: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class InstanceRemap:
    """A remapping of an instance with both names resolved; `used` is whether it changed the name of an interface.

    `similar` contains resolved names of the instance's interfaces as suggestions for its left side.
    """

    source: str
    target: str
    remap: Remap
    used: bool
    similar: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class NodeInstance:
    """One start of a node: `name` is absolute.

    `type` is its node type; None, with `reason` (a sentence) and `missing`, if it is not in the build. `plugins` are
    the node types of the plugins that it loads by parameters; `host` is the name of the instance whose process it
    shares. `complete` is whether all its interfaces are known: the type, all names and all plugins.
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
    """Time of the first observation (ISO 8601, UTC); None if started by a launch file."""
    similar: tuple[str, ...] = ()
    """Packages of the build as suggestions for its package, if that is not in the build."""

    @property
    def started_type(self) -> str:
        """Package and name of its node type, else of the program that the launch file starts, `?` for unknown parts.

        A running node without a node type in the store shows neither.
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
    """Observation of a running system: its address, and its start and end (ISO 8601, UTC), None while it goes on.

    `complete` is whether it lasted long enough to see the whole system.
    """

    address: str
    since: str
    until: str | None = None
    complete: bool = True


@dataclass(frozen=True, slots=True)
class System:
    """A configuration with its instances; `sighting` is the observation of a running system.

    `similar` contains pairs of names of one kind (`topic`, `service`, `action`) that probably should be equal: (kind,
    name, other name).
    """

    configuration: LaunchConfiguration
    instances: tuple[NodeInstance, ...] = ()
    similar: tuple[tuple[str, str, str], ...] = ()
    shared_parameters: tuple[LaunchParameter, ...] = ()
    """Parameters of ROS 1 outside the names of all instances."""
    sighting: Sighting | None = None
