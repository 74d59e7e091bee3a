"""Costs of nodes in chains, and the cheapest chains of steps from some types to others, in the order of their costs.

Nodes and types are a bipartite graph; a step goes from a type through a node to a type. A backward pass
from the goals computes a lower bound of the remaining cost for each type and number of steps left (Bellman 1957). The
forward search extends chains in the order of cost so far plus that bound (A*, Hart, Nilsson and Raphael 1968). Each
queued chain is an index in a sorted list of next steps, so chains are only created when they are visited.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from heapq import heappop, heappush
from itertools import count
from typing import TYPE_CHECKING, Final, TypeAlias

import msgspec

from kg import resources
from kg.search.words import words

if TYPE_CHECKING:
    from kg.search.compose.network import Part, Port


_FILE: Final = "composing.toml"
_SELDOM: Final = 3
_OFTEN: Final = 10  # how many launch files start a node that is started often, or all the time


class Costs(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The table `costs` of the file, in points."""

    node: int
    trial: int
    tool: int
    generic_link: int
    deprecated: int
    kind: dict[str, int]
    need: int
    most_needs: int
    side_port: int
    named_by_parameter: int
    unlike_type: int
    filters: int
    shared_name: int
    never_started: int
    seldom_started: int
    often_started: int
    never_together: int
    other_repository: int
    no_common_word: int
    other_name: int


class Words(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The table `words`: words of names."""

    trial: frozenset[str]
    tool: frozenset[str]
    side: frozenset[str]


class Types(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The table `types`: packages of types, words in their names, and whole types."""

    generic: frozenset[str]
    generic_words: frozenset[str]
    optional: frozenset[str]


class Knowledge(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The content of the file."""

    costs: Costs
    words: Words
    types: Types


@lru_cache(maxsize=1)
def knowledge() -> Knowledge:
    """Return the knowledge shipped with `kg`."""
    return msgspec.convert(resources.table_of("ontology", _FILE), Knowledge)


@lru_cache(maxsize=1 << 12)
def generic(type_name: str) -> bool:
    """Return whether a type is too generic to link nodes by."""
    package = type_name.partition("/")[0]
    types = knowledge().types
    return package in types.generic or not types.generic_words.isdisjoint(words(package))


def needs(part: Part, taken: Port) -> tuple[Port, ...]:
    """Return the subscriptions of a node other than its input in a chain, without topics that it publishes itself."""
    own = {port.topic for port in part.outputs}
    return tuple(
        port
        for port in part.inputs
        if port.iri != taken.iri
        and (port.topic is None or (port.topic != taken.topic and port.topic not in own))
        and not generic(port.type)
    )


def demerits(part: Part) -> tuple[str, ...]:
    """Return the arguments against reusing a node, in words."""
    listed = knowledge().words
    named = {*words(part.package), *words(part.name)}
    arguments = []
    trial = sorted(listed.trial & {*named, *words(part.path.rpartition("/")[0])})
    if trial:
        arguments.append(f"`{trial[0]}` in its name or folder: a test, demo or example")
    tool = sorted(listed.tool & named)
    if tool:
        arguments.append(f"`{tool[0]}` in its name: a tool that passes on, keeps or shows messages")
    if part.deprecated:
        arguments.append("its package is deprecated")
    return tuple(arguments)


def part_cost(part: Part) -> int:
    """Return the cost of a node, independent of its place."""
    costs, listed = knowledge().costs, knowledge().words
    named = {*words(part.package), *words(part.name)}
    cost = costs.node + costs.kind.get(part.kind, 0)
    cost += costs.trial if listed.trial & {*named, *words(part.path.rpartition("/")[0])} else 0
    cost += costs.tool if listed.tool & named else 0
    cost += costs.deprecated if part.deprecated else 0
    return cost + _rarity(part, costs)


def _rarity(part: Part, costs: Costs) -> int:
    if not part.started:
        return costs.never_started
    return costs.seldom_started if part.started < _SELDOM else costs.often_started if part.started < _OFTEN else 0


def link_cost(giver: tuple[Part, Port], taker: tuple[Part, Port]) -> int:
    """Return the cost of linking two nodes not made for each other."""
    costs = knowledge().costs
    (one, given), (other, taken) = giver, taker
    cost = 0 if one.repository == other.repository else costs.other_repository
    cost += 0 if together(one, other) else costs.never_together
    names = [port.name.rpartition("/")[2] if port.name is not None else "" for port in (given, taken)]
    if names[0] and names[0] == names[1]:
        return cost
    return cost + (costs.no_common_word if _words(names[0]).isdisjoint(_words(names[1])) else costs.other_name)


def together(one: Part, other: Part) -> int:
    """Return how many launch files of the store start both nodes."""
    return len(set(one.launches).intersection(other.launches))


@lru_cache(maxsize=1 << 14)
def _words(name: str) -> frozenset[str]:
    return frozenset(words(name))


def port_cost(port: Port) -> int:
    """Return the cost of an end, higher for side outputs, names unlike the type, and names from parameters."""
    costs, side = knowledge().costs, knowledge().words.side
    if port.name is None:
        return costs.named_by_parameter
    named = _words(port.name)
    cost = 0 if named.isdisjoint(side) else costs.side_port
    return cost + (costs.unlike_type if named.isdisjoint(_words(port.type.rpartition("/")[2])) else 0)


_MOST_LOOKS: Final = 150_000  # how many steps are looked at before a search ends with what it has; some seconds


@dataclass(frozen=True, slots=True)
class Step:
    """A node in a chain: it receives `source` at the input `taken` and publishes `target` at the output `given`.

    `marks` contains the bits of the requirements that it meets. `key` orders steps of equal cost. A `required` step may
    publish the type that it receives.
    """

    part: int
    family: int
    source: str
    target: str
    cost: int
    key: str = ""
    marks: int = 0
    taken: int = 0
    given: int = 0
    required: bool = False


@dataclass(frozen=True, slots=True)
class Chain:
    """Steps, each of which receives the output of the one before; `cost` includes the links between them.

    `type` is the type that the last one publishes, `marks` contains the bits of the requirements that all meet.
    """

    cost: int
    steps: tuple[Step, ...]
    type: str
    marks: int

    @property
    def keys(self) -> tuple[str, ...]:
        """The sort key among chains of the same cost."""
        return tuple(step.key for step in self.steps)


_Follow: TypeAlias = "list[tuple[int, str, Step]]"
_Waiting: TypeAlias = "list[tuple[int, tuple[str, ...], int, int | None, Chain]]"
"""Lower bound of the chain's cost, its keys, a number, the index of its next step (None: none), and the path."""


@dataclass(slots=True)
class Search:
    """A search: chains of at most `length` steps from one of `starts` to one of `goals`.

    `steps` contains all steps by input type. A chain must have all bits of `wanted`; `start_marks` contains those of
    the possible first types. `between` returns the cost of linking two steps, 0 or more. No family and no type occurs
    twice in a chain, except the goal of a search from a type to itself, and types of `required` steps.
    """

    steps: Mapping[str, Sequence[Step]]
    starts: Sequence[str]
    goals: frozenset[str]
    length: int
    between: Callable[[Step, Step], int] = lambda _one, _other: 0
    wanted: int = 0
    start_marks: Mapping[str, int] = field(default_factory=dict)
    visited: int = 0
    """Number of visited steps; the search is cut off at a limit."""
    _remaining: list[dict[tuple[str, int], int]] = field(default_factory=list)
    _numbers: Iterator[int] = field(default_factory=count)
    _cache: dict[tuple[str, int, int], _Follow] = field(default_factory=dict)

    @property
    def cut_off(self) -> bool:
        """Whether the search ended before it was complete."""
        return self.visited >= _MOST_LOOKS

    def best(self) -> Iterator[Chain]:
        """Yield the chains by increasing cost, then by their keys, without repeating chains of the same nodes.

        The queue has the same order, and an extension never precedes its chain. So a complete chain at the head of the
        queue is the next result. If the search is cut off, the complete chains still in the queue follow.
        """
        self._bound_costs()
        waiting: _Waiting = []
        for start in sorted(set(self.starts)):
            self._queue(waiting, Chain(0, (), start, self.start_marks.get(start, 0) & self.wanted), 0)
        seen: set[tuple[int, ...]] = set()
        while waiting:
            _, _, _, place, path = heappop(waiting)
            if place is None:
                families = tuple(step.family for step in path.steps)
                if families not in seen:
                    seen.add(families)
                    yield path
            elif not self.cut_off:
                self._extend(waiting, path, place)

    def _extend(self, waiting: _Waiting, path: Chain, place: int) -> None:
        self.visited += 1
        self._queue(waiting, path, place + 1)
        step = self._follow(path)[place][2]
        grown = self._grown(path, step)
        if grown is None:
            return
        if self._ends(step, grown.marks):
            heappush(waiting, (grown.cost, grown.keys, next(self._numbers), None, grown))
        else:
            self._queue(waiting, grown, 0)

    def _queue(self, waiting: _Waiting, path: Chain, place: int) -> None:
        follow = self._follow(path)
        if place < len(follow):
            bound, key, _ = follow[place]
            heappush(waiting, (path.cost + bound, (*path.keys, key), next(self._numbers), place, path))

    def _grown(self, path: Chain, step: Step) -> Chain | None:
        """Return a path with one more step, None if that step is not allowed."""
        if any(one.family == step.family for one in path.steps):
            return None
        marks = path.marks | (step.marks & self.wanted)
        had = {path.steps[0].source if path.steps else path.type, *(one.target for one in path.steps), *self.starts}
        keeps = step.required and step.source == step.target
        if step.target in had and not keeps and not self._ends(step, marks):
            return None
        between = self.between(path.steps[-1], step) if path.steps else 0
        return Chain(path.cost + step.cost + between, (*path.steps, step), step.target, marks)

    def _ends(self, step: Step, marks: int) -> bool:
        return step.target in self.goals and marks & self.wanted == self.wanted

    def _bound_costs(self) -> None:
        """Compute lower bounds of the remaining cost, by type and bits, for each number of steps."""
        edges = self._edges()
        subsets = [marks for marks in range(self.wanted + 1) if marks & self.wanted == marks]
        self._remaining = [{}]
        for _ in range(self.length):
            before = self._remaining[-1]
            now: dict[tuple[str, int], int] = {}
            for (source, target, marks), cost in edges.items():
                for had in subsets:
                    has = had | marks
                    ends = target in self.goals and has == self.wanted
                    remaining = 0 if ends else before.get((target, has))
                    if remaining is not None and cost + remaining < now.get((source, had), cost + remaining + 1):
                        now[source, had] = cost + remaining
            self._remaining.append(now)

    def _edges(self) -> dict[tuple[str, str, int], int]:
        """Return the cheapest step between each two types, by its bits."""
        cheapest: dict[tuple[str, str, int], int] = {}
        for steps in self.steps.values():
            for step in steps:
                edge = step.source, step.target, step.marks & self.wanted
                if step.cost < cheapest.get(edge, step.cost + 1):
                    cheapest[edge] = step.cost
        return cheapest

    def _follow(self, path: Chain) -> _Follow:
        """Return the possible next steps, each with the lower bound of the remaining cost, the cheapest first."""
        left = self.length - len(path.steps)
        key = path.type, path.marks, left
        steps = self._cache.get(key)
        if steps is None:
            steps = self._cache[key] = sorted(self._bounded(*key), key=lambda one: (one[0], one[1]))
        return steps

    def _bounded(self, source: str, had: int, left: int) -> Iterator[tuple[int, str, Step]]:
        if left <= 0:
            return
        for step in self.steps.get(source, ()):
            has = had | (step.marks & self.wanted)
            remaining = 0 if self._ends(step, has) else self._remaining[left - 1].get((step.target, has))
            if remaining is not None:
                yield step.cost + remaining, step.key, step
