"""Conversion of an observed computation graph to the facts of a system, in the terms of launched systems.

The node types of running nodes come from `kg.robot.live.recognizing`, as records.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Final, TypeAlias
from urllib.parse import unquote, urlsplit

from kg.extract.implicit import load_table
from kg.facts import (
    InstanceInterface,
    Interface,
    LaunchConfiguration,
    LaunchDialect,
    LaunchProblem,
    LaunchProblemKind,
    Location,
    MissingType,
    NodeInstance,
    NodeReference,
    Resolution,
    Role,
    Sighting,
    StartedNode,
    StartKind,
    System,
)
from kg.graph.iris import RUNNING
from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode

    Similar: TypeAlias = Callable[[tuple[NodeInstance, ...], int], tuple[tuple[str, str, str], ...]]

NOWHERE: Final = NodeReference("", "", "")
"""The node type of an end that no code of a store declares."""
_UNKNOWN: Final = "no node type of the store has its name and its interface"


@dataclass(frozen=True, slots=True)
class Match:
    """The node type of a running node, and its interface for each of the node's ends."""

    type: NodeReference
    ends: Mapping[LiveEnd, Interface] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Seen:
    """Address, name and start (ISO 8601, UTC) of the observation of a graph.

    `nodes` has the times of nodes that appeared later; `until` is set when the observation ends.
    """

    address: str
    name: str
    since: str
    until: str | None = None
    nodes: Mapping[str, str] = field(default_factory=dict)

    def of(self, node: str) -> str:
        """Return since when a node has been seen."""
        return self.nodes.get(node, self.since)


def name_of(address: str) -> str:
    """Return the default name of a running system, from its address: `localhost:11311`, `dds/0`, `bag/drive.mcap`."""
    parts = urlsplit(address)
    place = (parts.netloc + parts.path).strip("/")
    if parts.scheme == "bag":
        place = re.sub(r"[^\w.-]+", "_", unquote(place).rpartition("/")[2])
    return place if parts.scheme == "ros1" else f"{parts.scheme}/{place}".rstrip("/")


class Instances:
    """The facts about nodes; an unchanged node keeps the same (`is`) facts."""

    def __init__(self) -> None:
        self._facts: dict[LiveNode, tuple[object, NodeInstance]] = {}

    def of(self, graph: ComputationGraph, seen: Seen, matches: Mapping[str, Match]) -> tuple[NodeInstance, ...]:
        """Return the facts about the nodes of a graph, in their order; parameters as `system_of`."""
        ends: defaultdict[str, list[LiveEnd]] = defaultdict(list)
        for end in graph.ends:
            ends[end.node].append(end)
        before, self._facts = self._facts, {}
        facts = []
        for node in graph.nodes:
            given = (ends[node.name], matches.get(node.name), graph.ros, seen.address, seen.of(node.name))
            same = before.get(node)
            if same is None or same[0] != given:
                same = given, _instance(node, ends[node.name], graph.ros, seen, matches.get(node.name))
            self._facts[node] = same
            facts.append(same[1])
        return tuple(facts)


def system_of(
    graph: ComputationGraph,
    seen: Seen,
    matches: Mapping[str, Match] | None = None,
    similar: Similar | None = None,
    previous: Instances | None = None,
) -> System:
    """Return the facts about a graph.

    `matches` are the node types of running nodes, by the name of the node. `similar`, if given, finds names that were
    probably meant to be equal, as `near_misses` of `kg.launch.wiring`. `previous` has the facts of nodes seen before.
    """
    instances = (previous or Instances()).of(graph, seen, matches or {})
    return System(
        _configuration(graph, seen),
        instances,
        similar(instances, graph.ros) if similar else (),
        sighting=Sighting(seen.address, seen.since, seen.until, graph.complete),
    )


def _configuration(graph: ComputationGraph, seen: Seen) -> LaunchConfiguration:
    return LaunchConfiguration(
        repository=RUNNING,
        package=RUNNING,
        path=seen.name,
        ros=graph.ros,
        dialect=LaunchDialect.RUNNING,
        problems=tuple(
            LaunchProblem(LaunchProblemKind.UNRESOLVED, one.message, Location(one.subject, 0), subject=one.subject)
            for one in graph.problems
        ),
    )


def _instance(node: LiveNode, ends: Sequence[LiveEnd], ros: int, seen: Seen, match: Match | None) -> NodeInstance:
    namespace, _, base = node.name.rpartition("/")
    peer = Location(f"{node.name} at {node.address or seen.address}", 0)
    return NodeInstance(
        name=node.name,
        namespace=namespace or "/",
        started=StartedNode(base, namespace or "/", StartKind.RUNNING, peer),
        type=match.type if match else None,
        reason=node.problem or (None if match else _UNKNOWN),
        missing=None if match else MissingType.NOT_SAID,
        interfaces=tuple(_interface(end, peer, ros, match) for end in ends),
        complete=node.problem is None,
        since=seen.of(node.name),
    )


def _interface(end: LiveEnd, peer: Location, ros: int, match: Match | None) -> InstanceInterface:
    matched = match.ends.get(end) if match else None
    declared = matched or Interface(
        role=end.role,
        name=end.name,
        type=end.type,
        resolution=Resolution.LITERAL,
        location=peer,
        implicit=is_implicit(end.role, end.name, end.node, ros),
        qos=end.qos,
    )
    return InstanceInterface(
        declared=declared,
        owner=match.type if match and matched else NOWHERE,
        resolved=end.name,
        resolution=Resolution.LITERAL,
        qos=end.qos,
    )


def is_implicit(role: Role, name: str, node: str, ros: int) -> bool:
    """Return whether ROS itself creates an end in every node, according to `ontology/implicit.toml`."""
    own = f"{node}/"
    return (role, f"~/{name.removeprefix(own)}" if name.startswith(own) else name) in _implicit_names(ros)


@cache
def _implicit_names(ros: int) -> frozenset[tuple[str, str]]:
    table = load_table(folder("ontology") / "implicit.toml")
    return frozenset(
        (row["role"], row["name"]) for use in table if use.mark == f"ros{ros}.node" for row in use.interfaces
    )
