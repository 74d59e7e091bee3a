"""Answer a request: the best chains for each version of ROS, wired."""

from __future__ import annotations

from dataclasses import dataclass
from heapq import merge
from itertools import islice, takewhile
from typing import TYPE_CHECKING, Final

from kg.search.compose.asking import Asked, asked
from kg.search.compose.chains import Chain, Search
from kg.search.compose.costs import demerits, knowledge, needs
from kg.search.compose.details import Details, read_details
from kg.search.compose.failing import nothing
from kg.search.compose.reading import network
from kg.search.compose.results import Answer, Composed, Node
from kg.search.compose.steps import between, steps_of
from kg.search.compose.wiring import Wiring, wire

if TYPE_CHECKING:
    from pathlib import Path

    from kg.search.compose.network import Network
    from kg.store.interface import Snapshot

__all__ = ["Answer", "Question", "compose", "searches"]

LENGTH: Final = 4
LIMIT: Final = 5
_VERSIONS: Final = (1, 2)


@dataclass(frozen=True, slots=True)
class Question:
    """A request for chains from any type of `sources` to any of `targets`, through everything in `using`.

    `ros` is 1 or 2, None for both; `limit` is the number of chains to return. `length` is the largest number
    of nodes; None means four, without chains longer than the best one by more than a node.
    """

    sources: tuple[str, ...]
    targets: tuple[str, ...]
    using: tuple[str, ...] = ()
    ros: int | None = None
    length: int | None = None
    limit: int = LIMIT

    @property
    def most(self) -> int:
        """Largest number of nodes in a chain."""
        return LENGTH if self.length is None else self.length


def compose(snapshot: Snapshot, question: Question, cache: Path | None = None) -> Answer:
    """Return the best chains, the best first.

    The network is cached in the folder `cache`, if given.

    Raises:
        UnknownNameError: KG705 for a type that no node has, KG706 if there is no chain, KG707 for an unknown name in
            `using`.
    """
    known = network(snapshot, cache)
    resolved = asked(known, snapshot, question.sources, question.targets, question.using)
    started = searches(known, resolved, question)
    found = merge(*(one.best() for one in started), key=lambda chain: (chain.cost, chain.keys))
    first = next(found, None)
    if first is None:
        raise nothing(known, resolved, question.using, question.ros, question.most)
    enough = first.cost + 2 * knowledge().costs.node if question.length is None else None
    worth = takewhile(lambda chain: enough is None or chain.cost < enough, found)
    chains = [first, *islice(worth, question.limit)]
    shown = [(chain, _wired(known, chain)) for chain in chains[: question.limit]]
    details = _details(snapshot, [wiring for _, wiring in shown])
    composed = tuple(_composed(known, chain, wiring, details) for chain, wiring in shown)
    return Answer(composed, resolved, len(chains) > question.limit, any(one.cut_off for one in started))


def searches(known: Network, request: Asked, question: Question) -> list[Search]:
    """Return a search for each requested version of ROS."""
    link = between(known)
    starts = {name: request.types.get(name, 0) for name in request.starts}
    return [
        Search(
            steps_of(known, request, ros), request.starts, request.goals, question.most, link, request.wanted, starts
        )
        for ros in _VERSIONS
        if question.ros in {None, ros}
    ]


def _wired(known: Network, chain: Chain) -> Wiring:
    parts = ((known.parts[step.part], step) for step in chain.steps)
    return wire([(part, part.inputs[step.taken], part.outputs[step.given]) for part, step in parts])


def _details(snapshot: Snapshot, wirings: list[Wiring]) -> Details:
    starts = [start for wiring in wirings for start in wiring.starts]
    ports = [port for start in starts for port in (start.taken, start.given)]
    return read_details(snapshot, [start.part for start in starts], ports)


def _composed(known: Network, chain: Chain, wiring: Wiring, details: Details) -> Composed:
    nodes = []
    published: set[tuple[str, str]] = set()
    for step, start in zip(chain.steps, wiring.starts, strict=True):
        part = start.part
        others = tuple(one for place, one in enumerate(known.parts) if one.family == step.family and place != step.part)
        wanted = needs(part, start.taken)
        fed = tuple(port for port in wanted if (start.own(port), port.type) in published)
        missing = tuple(port for port in wanted if port not in fed)
        nodes.append(Node(part, start, missing, fed, others, demerits(part)))
        published |= wiring.said(len(nodes) - 1)
    return Composed(tuple(nodes), wiring, details, chain.cost)
