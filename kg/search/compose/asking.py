"""Resolve a request in a network: its types, and the types and nodes that a chain must contain."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.errors import UnknownNameError
from kg.graph.ntriples import literal
from kg.query.rows import rows
from kg.search.words import words
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.search.compose.network import Network, Part
    from kg.store.interface import Snapshot

_INTERFACE_FOLDERS: Final = ("msg", "srv", "action")
_DESCRIBED: Final = (
    "SELECT DISTINCT ?n { GRAPH ?g { ?d rnkg:descriptionWord %s . ?n rnkg:hasDescription ?d ; a rnkg:NodeType } }"
)


@dataclass(frozen=True, slots=True)
class ResolvedRequest:
    """A request in terms of a network.

    Each required type or node has a bit: `types` and `parts` (indices in the network) map to their bits. `named`
    contains parts requested by name; they are allowed in a chain whatever their cost.
    """

    starts: tuple[str, ...]
    goals: frozenset[str]
    wanted: int = 0
    types: Mapping[str, int] = field(default_factory=dict)
    parts: Mapping[int, int] = field(default_factory=dict)
    named: frozenset[int] = frozenset()
    notes: tuple[str, ...] = ()
    """Explanations of names whose resolution is not obvious."""

    def marks(self, place: int, target: str) -> int:
        """Return the bits of a step through a part to a type."""
        return self.parts.get(place, 0) | self.types.get(target, 0)


def resolve_request(
    network: Network, snapshot: Snapshot, sources: Sequence[str], targets: Sequence[str], using: Sequence[str]
) -> ResolvedRequest:
    """Resolve types and names in a network.

    Raises UnknownNameError: KG705 for a type that no node publishes or subscribes, KG707 for a required name that
    matches no type, node, package or word.
    """
    types_of_network = network.published() | network.subscribed()
    starts = {name: matching_types(name, types_of_network) for name in sources}
    goals = {name: matching_types(name, types_of_network) for name in targets}
    notes = [f"`{name}` may be {', '.join(types)}" for name, types in {**starts, **goals}.items() if len(types) > 1]
    types: dict[str, int] = {}
    parts: dict[int, int] = {}
    named: set[int] = set()
    for place, name in enumerate(using):
        bit = 1 << place
        through, nodes, exact = _through(name, network, snapshot, types_of_network)
        for one in through:
            types[one] = types.get(one, 0) | bit
        for node in nodes:
            parts[node] = parts.get(node, 0) | bit
        named.update(nodes if exact else ())
    return ResolvedRequest(
        tuple(dict.fromkeys(one for matched in starts.values() for one in matched)),
        frozenset(one for matched in goals.values() for one in matched),
        (1 << len(using)) - 1,
        types,
        parts,
        frozenset(named),
        tuple(notes),
    )


def matching_types(name: str, offered: Iterable[str]) -> tuple[str, ...]:
    """Return the types matching `package/Type`, `package/msg/Type` or `Type`, sorted.

    Raises UnknownNameError: KG705 with similar names.
    """
    types = set(offered)
    matches = _types(name, types)
    if not matches:
        near = did_you_mean(name, [*types, *(one.rpartition("/")[2] for one in types)])
        message = f"no node of the store that can be started publishes or subscribes `{name}`"
        raise UnknownNameError("KG705", message, hint=near or "`kg topics` lists topics with their types.")
    return matches


def _types(name: str, offered: set[str]) -> tuple[str, ...]:
    parts = [part for part in name.strip().replace("::", "/").split("/") if part]
    short = "/".join(part for part in parts if part not in _INTERFACE_FOLDERS or len(parts) == 1)
    if short in offered:
        return (short,)
    matches = sorted(one for one in offered if one.rpartition("/")[2].lower() == short.lower())
    exact = [one for one in matches if one.rpartition("/")[2] == short]
    return tuple(exact or matches or [one for one in sorted(offered) if one.lower() == short.lower()])


def _through(
    name: str, network: Network, snapshot: Snapshot, offered: set[str]
) -> tuple[tuple[str, ...], list[int], bool]:
    """Return the types and the parts that a required name matches, and whether it is the exact name of parts."""
    types = _types(name, offered)
    if types and "/" in name:
        return types, [], False
    nodes = [place for place, part in enumerate(network.parts) if name in _names(part)]
    if nodes:
        return types, nodes, True
    wanted = set(words(name))
    places = {
        place
        for place, part in enumerate(network.parts)
        if wanted and wanted <= {*words(part.package), *words(part.name), *words(part.repository)}
    }
    described = {node for (node,) in rows(snapshot, _DESCRIBED % literal(name.lower()))}
    places.update(place for place, part in enumerate(network.parts) if part.iri in described)
    if not types and not places:
        names = {one for part in network.parts for one in (part.name, part.package)}
        near = did_you_mean(name, [*names, *offered])
        message = f"nothing in the store matches `{name}`: not a type, a node, a package or a word of their names"
        raise UnknownNameError("KG707", message, hint=near or "`kg nodes` lists the nodes, `kg search` finds them.")
    return types, sorted(places), False


def _names(part: Part) -> set[str | None]:
    return {
        part.name, part.full_name, f"{part.repository}:{part.full_name}", part.plugin, part.executable, part.package,
        part.name.rpartition("::")[2].rpartition("/")[2],
    }  # fmt: skip
