"""Answer a request: read the network of a store, find the best chains for each version of ROS, and wire them."""

from __future__ import annotations

from collections import defaultdict
from contextlib import suppress
from dataclasses import dataclass
from heapq import merge
from itertools import islice, product, takewhile
from typing import TYPE_CHECKING, Final

import msgspec

from kg.errors import UnknownNameError
from kg.facts import NodeKind, Role, Switch
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.graph.reading.queries import texts
from kg.holes import known_letters
from kg.names import FRAMEWORK
from kg.query.rows import rows
from kg.render.text import count
from kg.rules.selecting import columns_of
from kg.search.cache import keep, load_cached
from kg.search.compose.asking import ResolvedRequest, resolve_request
from kg.search.compose.chains import (
    Chain,
    Search,
    Step,
    demerits,
    generic,
    knowledge,
    link_cost,
    needs,
    part_cost,
    port_cost,
)
from kg.search.compose.details import Details, read_details
from kg.search.compose.network import Network, Part, Port
from kg.search.compose.results import Answer, Composed, Node
from kg.search.compose.wiring import Wiring, wire
from kg.search.folding import bare_name
from kg.similar import similar, suggest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.store.snapshot import EmbeddedSnapshot


def steps_of(network: Network, request: ResolvedRequest, ros: int) -> Mapping[str, Sequence[Step]]:
    """Return the best step of each family between each two types, by input type."""
    best: dict[tuple[int, str, str], Step] = {}
    for place, part in enumerate(network.parts):
        if part.ros != ros:
            continue
        for step in _through(part, place, request):
            way = part.family, step.source, step.target
            cheapest = best.get(way)
            if cheapest is None or (step.cost, step.key) < (cheapest.cost, cheapest.key):
                best[way] = step
    by_source: defaultdict[str, list[Step]] = defaultdict(list)
    for step in best.values():
        by_source[step.source].append(step)
    return by_source


def _through(part: Part, place: int, request: ResolvedRequest) -> Iterator[Step]:
    is_required = place in request.named
    costs, key = knowledge().costs, f"{part.full_name} {part.repository}"
    base = costs.node if is_required else part_cost(part)
    shared = frozenset({port.topic for port in part.inputs} & {port.topic for port in part.outputs} - {None})
    for source, taken in _best(part.inputs, shared).items():
        entry = part.inputs[taken]
        wanted = {port.type for port in needs(part, entry)}
        before = base + _cost(entry, shared) + _need_cost(wanted - (set(request.starts) - {source}))
        before += request.starts.index(source) if source in request.starts else 0
        for target, given in _best(part.outputs, shared, entry).items():
            if source == target and not is_required and not (source in request.starts and source in request.goals):
                continue
            cost = before + _cost(part.outputs[given], shared) + (costs.filters if target in wanted else 0)
            if generic(target) and target not in request.goals:
                cost += costs.generic_link
            marks = request.marks(place, target)
            yield Step(place, part.family, source, target, cost, key, marks, taken, given, is_required)


def _best(ports: Sequence[Port], shared: frozenset[str | None], taken: Port | None = None) -> dict[str, int]:
    """Return the index of the best end of each type; outputs must be compatible with the input `taken`."""
    places: dict[str, int] = {}
    for place, port in enumerate(ports):
        if not port.can_be_wired or (taken is not None and not _together(taken, port)):
            continue
        other = places.get(port.type)
        if other is None or _rank(port, shared) < _rank(ports[other], shared):
            places[port.type] = place
    return places


def _rank(port: Port, shared: frozenset[str | None]) -> tuple[int, int, str]:
    return _cost(port, shared), len(port.switches), port.name or ""


def _cost(port: Port, shared: frozenset[str | None]) -> int:
    return port_cost(port) + (knowledge().costs.shared_name if port.topic in shared else 0)


def _together(taken: Port, given: Port) -> bool:
    """Return whether a node can have both ends at the same time, under different names."""
    if taken.topic is not None and taken.topic == given.topic:
        return False
    if taken.name is None and taken.parameter == given.parameter and given.name is None:
        return False
    pairs = product(map(Switch.parse, taken.switches), map(Switch.parse, given.switches))
    return not any(_exclude(one, other) for one, other in pairs)


def _exclude(one: Switch, other: Switch) -> bool:
    """Check whether no value of a parameter meets both conditions."""
    if one.parameter != other.parameter:
        return False
    if (one.sign, one.value) == (other.sign, other.value):
        return one.wanted != other.wanted
    return one.wanted and other.wanted and one.sign == other.sign == "=="


def _need_cost(wanted: set[str]) -> int:
    costs, optional = knowledge().costs, knowledge().types.optional
    return min(costs.need * len(wanted - optional), costs.most_needs)


def between(network: Network) -> Callable[[Step, Step], int]:
    """Return the cost of linking one step to the next."""
    parts = network.parts

    def cost(one: Step, other: Step) -> int:
        giver, taker = parts[one.part], parts[other.part]
        return link_cost((giver, giver.outputs[one.given]), (taker, taker.inputs[other.taken]))

    return cost


_DEPRECATED: Final = """
SELECT ?repository ?package {
  ?r a rnkg:Repository ; rnkg:name ?repository ; rnkg:contains ?p .
  ?p a rnkg:Package ; rnkg:name ?package ; rnkg:deprecated ?value
}"""
_STARTED: Final = "SELECT ?n ?g { GRAPH ?g { ?i rnkg:instanceOf ?n } }"
_LOADED: Final = frozenset({NodeKind.NODELET, NodeKind.COMPONENT})
_FOLDER: Final = "compose"


def network(snapshot: EmbeddedSnapshot, cache: Path | None) -> Network:
    """Return the network of a snapshot, from the folder `cache` if present; else read it and save it there."""
    if cache is None:
        return read(snapshot)
    body = load_cached(cache / _FOLDER, snapshot.identity)
    if body is not None:
        return msgspec.json.decode(body, type=Network)
    network_read = read(snapshot)
    # In a read-only store the network is read each time.
    with suppress(OSError):
        keep(cache / _FOLDER, snapshot.identity, [msgspec.json.encode(network_read)])
    return network_read


def read(snapshot: EmbeddedSnapshot) -> Network:
    """Return the network of a snapshot: nodes that launch files can start and that have publishers or subscribers."""
    columns = columns_of(snapshot)
    deprecated = set(texts(columns, _DEPRECATED))
    launches = _numbered(rows(snapshot, _STARTED))
    parts = []
    for record in node_records(columns):
        node = record.node
        inputs, outputs = (_ports(record, role) for role in (Role.SUBSCRIBES, Role.PUBLISHES))
        if (inputs or outputs) and (node.executable or (node.plugin and node.kind in _LOADED)):
            parts.append(
                Part(
                    record.iri,
                    record.repository,
                    record.package,
                    node.name,
                    str(node.kind),
                    node.ros,
                    node.location.path,
                    node.location.line,
                    node.executable or None,
                    node.plugin or None,
                    node.node_name or None,
                    (record.repository, record.package) in deprecated,
                    launches=launches.get(record.iri, ()),
                    inputs=inputs,
                    outputs=outputs,
                )
            )
    parts.sort(key=lambda one: (one.repository, one.package, one.name, one.path, one.line, one.iri))
    return Network(_with_families(parts))


def _numbered(rows: Iterable[tuple[str, ...]]) -> dict[str, tuple[int, ...]]:
    """Return the numbers of the graphs that contain each node."""
    pairs = sorted(set(rows))
    numbers = {graph: place for place, graph in enumerate(sorted({graph for _, graph in pairs}))}
    by_node: defaultdict[str, list[int]] = defaultdict(list)
    for node, graph in pairs:
        by_node[node].append(numbers[graph])
    return {node: tuple(sorted(places)) for node, places in by_node.items()}


def _ports(record: NodeRecord, role: Role) -> tuple[Port, ...]:
    """Return the ends of a node in a role, without those of frameworks, sorted by IRI."""
    ends = ((iri, end) for end, iri in record.ends.items() if end.role is role and end.type and not end.implicit)
    return tuple(
        Port(
            iri,
            end.name if end.name and known_letters(end.name) else None,
            end.type or "",
            end.parameter,
            tuple(sorted(end.switches)),
            end.arguments,
        )
        for iri, end in sorted(ends, key=lambda one: one[0])
        if end.name is None or f"/{end.name.lstrip('/')}" not in FRAMEWORK
    )


def _with_families(parts: list[Part]) -> list[Part]:
    """Return the parts with their families: equal names of nodes and packages, ignoring words of form."""
    first: dict[tuple[int, str, str], int] = {}
    return [
        msgspec.structs.replace(part, family=first.setdefault((part.ros, part.package, bare_name(part.name)), place))
        for place, part in enumerate(parts)
    ]


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


def compose(snapshot: EmbeddedSnapshot, question: Question, cache: Path | None = None) -> Answer:
    """Return the best chains, the best first.

    The network is cached in the folder `cache`, if given.

    Raises UnknownNameError: KG705 for a type that no node has, KG706 if there is no chain, KG707 for an unknown name in
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
    details = read_details(snapshot, [start.part for start in starts])
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
