"""The fields of a document with their weights, and the terms of each.

Fields are combined before they are scored, as a weighted sum of how often a term stands in each (Robertson, Zaragoza
and Taylor 2004, "Simple BM25 extension to multiple weighted fields"): a term in the name counts as often as the
weight of the name, and a long page about the whole package does not drown the one sentence about the node.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.holes import anonymous
from kg.search.folding import is_main
from kg.search.words import name_terms, terms

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.search.documents import Document, PackageDocument
    from kg.search.reading import Content

__all__ = ["FIELDS", "LEAST", "Field", "documents", "own_words", "shared_words", "weighted"]

_COMMON: Final = ("name", "text", "interface", "type", "parameter", "class")
"""What variants of a node have in common."""

LEAST: Final = 0.5
"""The weighted occurrences that a term has in a document at least, in whatever field it stands."""
_PROSE: Final = ("manifest", "readme")
_MAIN: Final = 3
"""What a word about a package counts for its main node, beside what it counts for others."""


@dataclass(frozen=True, slots=True)
class Field:
    """A part of a document: what one occurrence of a term in it counts, and how many occurrences count at most.

    With a weight of zero a field adds nothing to others; a term that is in no other counts `LEAST`, as any does.
    """

    weight: float
    most: int


FIELDS: Final = {
    "name": Field(14.0, 2),
    "plugin": Field(0.0, 1),
    "package": Field(1.5, 1),
    "repository": Field(1.0, 1),
    "text": Field(2.0, 1),
    "manifest": Field(3.0, 1),
    "readme": Field(1.5, 2),
    "interface": Field(1.5, 2),
    "type": Field(1.0, 2),
    "parameter": Field(0.7, 2),
    "class": Field(1.5, 1),
    "neighbour": Field(0.0, 1),
}


def own_words(node: Document) -> Iterator[tuple[str, str]]:
    """Yield the texts of a node with the field each belongs to."""
    for name in (node.name, node.executable, node.node_name, *node.aliases):
        if name:
            yield "name", name
    if node.plugin:
        yield "plugin", node.plugin.rpartition("::")[2].rpartition("/")[2]
    for text in node.texts:
        yield "text", text.text
    for end in node.ends:
        if end.name:
            yield "interface", anonymous(end.name)
        if end.type:
            yield "type", end.type.rpartition("/")[2]
    for name, told in node.parameters:
        yield "parameter", name
        if told:
            yield "parameter", told
    for label in (*node.hardware, *node.functions, *node.capabilities):
        yield "class", label
    for other in (*node.feeds, *node.fed):
        yield "neighbour", other


def shared_words(package: PackageDocument) -> Iterator[tuple[str, str]]:
    """Yield the texts that the nodes of a package share."""
    yield "package", package.name
    yield "repository", package.repository.rpartition("/")[2]
    if package.description:
        yield "manifest", package.description
    for text in package.texts:
        if text.kind != "manifest":
            yield "readme", text.text


def counted(texts: Iterable[tuple[str, str]]) -> dict[str, Counter[str]]:
    """Return how often each term stands in each field."""
    found: dict[str, Counter[str]] = {}
    for field, text in texts:
        found.setdefault(field, Counter()).update(set(name_terms(text)) if field == "name" else terms(text))
    return found


def documents(content: Content, groups: Sequence[int]) -> list[dict[str, Counter[str]]]:
    """Return the fields of each node, with how much each term counts in them.

    Variants of one node have each other's texts, for who wrote about one meant both.
    """
    shared = [_capped(counted(shared_words(package))) for package in content.packages]
    own = [_capped(counted(own_words(node))) for node in content.nodes]
    members: defaultdict[tuple[int, int], list[int]] = defaultdict(list)
    for place, (node, group) in enumerate(zip(content.nodes, groups, strict=True)):
        members[group, node.package].append(place)
    for places in members.values():
        for field in _COMMON if len(places) > 1 else ():
            union: Counter[str] = Counter()
            for place in places:
                union |= own[place].get(field, Counter())
            for place in places:
                own[place][field] = union
    sizes = Counter(node.package for node in content.nodes)
    found = []
    for node, group, fields in zip(content.nodes, groups, own, strict=True):
        package = content.packages[node.package]
        main = is_main(node, package, len(members[group, node.package]), sizes[node.package])
        found.append({**(_told(shared[node.package]) if main else shared[node.package]), **fields})
    return found


def _capped(fields: dict[str, Counter[str]]) -> dict[str, Counter[str]]:
    return {
        name: Counter({term: min(count, FIELDS[name].most) for term, count in counts.items()})
        for name, counts in fields.items()
    }


def _told(fields: dict[str, Counter[str]]) -> dict[str, Counter[str]]:
    """Return the fields of a package as those of its main node."""
    return {
        name: Counter({term: count * _MAIN for term, count in counts.items()}) if name in _PROSE else counts
        for name, counts in fields.items()
    }


def weighted(fields: dict[str, Counter[str]]) -> dict[str, float]:
    """Return the weighted frequency of each term."""
    total: defaultdict[str, float] = defaultdict(float)
    for name, counts in fields.items():
        for term, count in counts.items():
            total[term] += FIELDS[name].weight * count
    return total
