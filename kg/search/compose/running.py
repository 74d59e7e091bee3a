"""Answer a request: the best chains for each version of ROS, wired."""

from __future__ import annotations

from dataclasses import dataclass
from heapq import merge
from itertools import islice, takewhile
from typing import TYPE_CHECKING, Final

from kg.errors import UnknownNameError
from kg.render.text import count
from kg.search.compose.asking import ResolvedRequest, resolve_request
from kg.search.compose.chains import Chain, Search, Step
from kg.search.compose.costs import demerits, generic, knowledge, needs
from kg.search.compose.details import Details, read_details
from kg.search.compose.reading import network
from kg.search.compose.results import Answer, Composed, Node
from kg.search.compose.steps import between, steps_of
from kg.search.compose.wiring import Wiring, wire
from kg.similar import similar, suggest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
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
    of_store = network(snapshot, cache)
    resolved = resolve_request(of_store, snapshot, question.sources, question.targets, question.using)
    started = searches(of_store, resolved, question)
    chains_by_cost = merge(*(one.best() for one in started), key=lambda chain: (chain.cost, chain.keys))
    first = next(chains_by_cost, None)
    if first is None:
        raise nothing(of_store, resolved, question.using, question.ros, question.most)
    enough = first.cost + 2 * knowledge().costs.node if question.length is None else None
    worth = takewhile(lambda chain: enough is None or chain.cost < enough, chains_by_cost)
    chains = [first, *islice(worth, question.limit)]
    shown = [(chain, _wired(of_store, chain)) for chain in chains[: question.limit]]
    starts = [start for _, wiring in shown for start in wiring.starts]
    ports = [port for start in starts for port in (start.taken, start.given)]
    details = read_details(snapshot, [start.part for start in starts], ports)
    composed = tuple(_composed(of_store, chain, wiring, details) for chain, wiring in shown)
    return Answer(composed, resolved, len(chains) > question.limit, any(one.cut_off for one in started))


def searches(nodes: Network, request: ResolvedRequest, question: Question) -> list[Search]:
    """Return a search for each requested version of ROS."""
    link = between(nodes)
    starts = {name: request.types.get(name, 0) for name in request.starts}
    return [
        Search(
            steps_of(nodes, request, ros), request.starts, request.goals, question.most, link, request.wanted, starts
        )
        for ros in _VERSIONS
        if question.ros in {None, ros}
    ]


def _wired(nodes: Network, chain: Chain) -> Wiring:
    parts = ((nodes.parts[step.part], step) for step in chain.steps)
    return wire([(part, part.inputs[step.taken], part.outputs[step.given]) for part, step in parts])


def _composed(of_store: Network, chain: Chain, wiring: Wiring, details: Details) -> Composed:
    nodes = []
    published: set[tuple[str, str]] = set()
    for step, start in zip(chain.steps, wiring.starts, strict=True):
        part = start.part
        others = tuple(
            one for place, one in enumerate(of_store.parts) if one.family == step.family and place != step.part
        )
        wanted = needs(part, start.taken)
        fed = tuple(port for port in wanted if (start.own(port), port.type) in published)
        missing = tuple(port for port in wanted if port not in fed)
        nodes.append(Node(part, start, missing, fed, others, demerits(part)))
        published |= wiring.published(len(nodes) - 1)
    return Composed(tuple(nodes), wiring, details, chain.cost)


_SHOWN: Final = 6


def nothing(
    network: Network, request: ResolvedRequest, using: Sequence[str], ros: int | None, length: int
) -> UnknownNameError:
    """Return the error KG706 for a request without result, with the types that can be reached."""
    sides = (", ".join(request.starts), ", ".join(sorted(request.goals)))
    through = f" through {', '.join(f'`{one}`' for one in using)}" if using else ""
    version = f" of ROS {ros}" if ros else ""
    message = f"no chain of at most {length} nodes{version} turns {sides[0]} into {sides[1]}{through}"
    lines = [*_missing(network, request, ros)]
    for one in (1, 2):
        if ros in {None, one}:
            lines += _reached(network, request, length, one)
    if using:
        lines.append("Without `--using` there may be one.")
    return UnknownNameError("KG706", message, hint="\n".join(lines) or "`kg topics` lists topics with their types.")


def _missing(network: Network, request: ResolvedRequest, ros: int | None) -> Iterator[str]:
    """Yield the types that no node subscribes to, or publishes."""
    parts = [part for part in network.parts if ros in {None, part.ros}]
    taken = {port.type for part in parts for port in part.inputs}
    given = {port.type for part in parts for port in part.outputs}
    for verb, wanted, offered in (("subscribes", request.starts, taken), ("publishes", sorted(request.goals), given)):
        for name in wanted:
            if name not in offered:
                last = {one.rpartition("/")[2]: one for one in sorted(offered, reverse=True)}
                near = suggest([last[one] for one in similar(name.rpartition("/")[2], last)])
                version = f" of ROS {ros}" if ros else ""
                yield f"No node{version} that can be started {verb} {name}.{f' {near}' if near else ''}"


def _reached(network: Network, request: ResolvedRequest, length: int, ros: int) -> Iterator[str]:
    """Yield the types reachable from the starts, with the longest path, and those that lead to the goals."""
    steps = steps_of(network, ResolvedRequest(request.starts, request.goals), ros)
    forwards = _levels(steps, request.starts, length)
    behind = {name: level for name, level in forwards.items() if level}
    if behind:
        farthest = max(sorted(behind), key=lambda name: behind[name])
        yield f"ROS {ros}: {', '.join(request.starts)} becomes {_some(behind)}."
        search = Search(steps, request.starts, frozenset({farthest}), length, between(network))
        chain = next(search.best(), None)
        if chain is not None:
            yield f"ROS {ros}: the longest way goes {_way(network, chain)}."
    back: dict[str, list[Step]] = {}
    for following in steps.values():
        for step in following:
            back.setdefault(step.target, []).append(step)
    before = _levels(back, sorted(request.goals), length, backwards=True)
    sources = {name: level for name, level in before.items() if level}
    if sources:
        yield f"ROS {ros}: {', '.join(sorted(request.goals))} is made of {_some(sources)}."


def _levels(
    steps: Mapping[str, Sequence[Step]], starts: Iterable[str], length: int, *, backwards: bool = False
) -> dict[str, int]:
    """Return the reachable types that are not generic, with the least number of nodes for each."""
    levels = dict.fromkeys(starts, 0)
    edge = list(levels)
    for level in range(1, length + 1):
        reached = [step.source if backwards else step.target for name in edge for step in steps.get(name, ())]
        edge = [name for name in dict.fromkeys(sorted(reached)) if name not in levels and not generic(name)]
        levels.update(dict.fromkeys(edge, level))
    return levels


def _some(levels: Mapping[str, int]) -> str:
    names = sorted(levels, key=lambda name: (levels[name], name))
    more = f" and {count(len(names) - _SHOWN, 'more type')}" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more


def _way(network: Network, chain: Chain) -> str:
    nodes = (f"{network.parts[step.part].full_name} -> {step.target}" for step in chain.steps)
    return " -> ".join((chain.steps[0].source, *nodes))
