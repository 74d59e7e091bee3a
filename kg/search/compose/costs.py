"""The cost of a node in a chain, and the reasons in words; fewer points are better (`ontology/composing.toml`)."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final

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
