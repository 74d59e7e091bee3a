"""Steps of chains: each pair of input and output of each node for a version of ROS, with its cost."""

from __future__ import annotations

from collections import defaultdict
from itertools import product
from typing import TYPE_CHECKING

from kg.facts import Switch
from kg.search.compose.chains import Step
from kg.search.compose.costs import generic, knowledge, link_cost, needs, part_cost, port_cost

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from kg.search.compose.asking import ResolvedRequest
    from kg.search.compose.network import Network, Part, Port


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
    """Yield the steps of a node."""
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
