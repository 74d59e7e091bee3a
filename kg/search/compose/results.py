"""Results: chains of nodes with all their details."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

from kg.facts import Location, NodeKind, NodeType
from kg.graph.reading.nodes import NodeRecord
from kg.graph.records import how_to_start
from kg.render.text import count
from kg.search.compose.chains import together
from kg.search.compose.launching import launch_text
from kg.search.compose.network import Part, Port, grouped

if TYPE_CHECKING:
    from kg.search.compose.asking import ResolvedRequest
    from kg.search.compose.details import Details
    from kg.search.compose.wiring import Start, Wiring

LAUNCH_ENDS: Final = {1: ".launch", 2: ".launch.py"}


@dataclass(frozen=True, slots=True)
class Node:
    """A node of a chain.

    `fed` contains other inputs published by earlier nodes of the chain, `needs` the inputs that no node publishes.
    `others` contains its variants and copies, `demerits` the arguments against reusing it.
    """

    part: Part
    start: Start
    needs: tuple[Port, ...] = ()
    fed: tuple[Port, ...] = ()
    others: tuple[Part, ...] = ()
    demerits: tuple[str, ...] = ()

    @property
    def remarks(self) -> tuple[str, ...]:
        """Arguments for and against the node, in words."""
        return (*((f"{_starting(self.part.started)} it",) if self.part.started else ()), *self.demerits)

    @property
    def how_to_start(self) -> str | None:
        """The command that starts the node alone."""
        part = self.part
        fact = NodeType(
            part.name, NodeKind(part.kind), "", part.ros, Location(part.path, part.line), part.executable, part.plugin
        )
        return how_to_start(NodeRecord(part.repository, None, part.package, fact))


@dataclass(frozen=True, slots=True)
class Composed:
    """A wired chain; `types` contains the types of the input, of the links, and of the output."""

    nodes: tuple[Node, ...]
    wiring: Wiring
    details: Details
    cost: int

    @property
    def types(self) -> tuple[str, ...]:
        """The types from the input to the output."""
        return tuple(link.type for link in self.wiring.links)

    @property
    def file_name(self) -> str:
        """Name of its launch file."""
        first, last = (name.rpartition("/")[2].lower() for name in (self.types[0], self.types[-1]))
        return f"{first}_to_{last}{LAUNCH_ENDS[self.wiring.ros]}"

    @property
    def reasons(self) -> tuple[str, ...]:
        """Remarks on the chain as a whole, in words."""
        remarks = [f"{count(len(self.nodes), 'node')} of ROS {self.wiring.ros}"]
        repositories = {node.part.repository for node in self.nodes}
        if len(self.nodes) > 1 and len(repositories) == 1:
            remarks.append(f"all of {repositories.pop()}")
        for one, other in pairwise(self.nodes):
            if number := together(one.part, other.part):
                remarks.append(f"{_starting(number)} {one.part.name} and {other.part.name} together")
        return tuple(remarks)


@dataclass(frozen=True, slots=True)
class Answer:
    """The best chains; `more`: others exist, `cut_off`: the search ended before it was complete."""

    chains: tuple[Composed, ...]
    request: ResolvedRequest
    more: bool = False
    cut_off: bool = False


def _starting(number: int) -> str:
    return "one launch file of the store starts" if number == 1 else f"{number:,} launch files of the store start"


def composed_object(chain: Composed, rank: int) -> dict[str, Any]:
    """Return a chain as plain values, ready for JSON; the fields of docs/compose.md."""
    return {
        "rank": rank,
        "ros": chain.wiring.ros,
        "types": list(chain.types),
        "nodes": [_node_object(chain, place) for place in range(len(chain.nodes))],
        "reasons": list(chain.reasons),
        "cost": chain.cost,
        "launch_file": chain.file_name,
        "launch": launch_text(chain),
    }


def _node_object(chain: Composed, place: int) -> dict[str, Any]:
    node, links = chain.nodes[place], chain.wiring.links
    part, start = node.part, node.start
    return {
        "repository": part.repository,
        "package": part.package,
        "node": part.name,
        "kind": part.kind,
        "start": node.how_to_start,
        "name": start.name,
        "file": part.path,
        "line": part.line,
        "takes": _end_object(chain, part, start.taken, links[place].topic),
        "gives": _end_object(chain, part, start.given, links[place + 1].topic),
        "also_needs": [{"type": kind, "names": names} for kind, names in grouped(node.needs)],
        "also_gets": [{"type": kind, "names": names} for kind, names in grouped(node.fed)],
        "also_as": [f"{one.repository}:{one.full_name}" for one in node.others],
        "started_by": part.started,
        "remarks": list(node.remarks),
    }


def _end_object(chain: Composed, part: Part, port: Port, topic: str) -> dict[str, Any]:
    place = chain.details.place(port, part)
    return {
        "name": port.name,
        "parameter": port.parameter,
        "type": port.type,
        "topic": topic,
        "file": place.path,
        "line": place.line,
        "file_repository": place.repository,
    }
