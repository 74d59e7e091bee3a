"""Fields of a document, and the weight of each term in them (weights: `ontology/search.toml`).

Fields are combined before scoring, as a weighted sum of term frequencies (Robertson, Zaragoza and Taylor 2004, "Simple
BM25 extension to multiple weighted fields"). So a term in the name counts with the weight of the name, and a long page
about the whole package does not outweigh a single sentence about the node.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING, Final

from kg.holes import anonymous
from kg.search.folding import is_main
from kg.search.lexicon import lexicon
from kg.search.words import joined, name_terms, terms

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.search.documents import Document, PackageDocument
    from kg.search.reading import Content

_COMMON: Final = ("name", "plugin", "text", "interface", "type", "parameter", "class")
"""Fields that variants of a node share."""
_PROSE: Final = ("manifest", "readme")
_OFTEN: Final = 2.0  # upper bound of the count of a term in a field
_SHORTEST: Final = 0.2  # minimum length of a field, relative to the mean of all nodes


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
    for name, description in node.parameters:
        yield "parameter", name
        if description:
            yield "parameter", description
    for label in (*node.hardware, *node.functions, *node.capabilities):
        yield "class", label


def shared_words(package: PackageDocument) -> Iterator[tuple[str, str]]:
    """Yield the texts that the nodes of a package share."""
    yield "package", package.name
    if package.description:
        yield "manifest", package.description
    for text in package.texts:
        if text.kind == "usage":
            yield "usage", f"{text.heading or ''} {text.text}"
        elif text.kind != "manifest":
            yield "readme", text.text


def counted(texts: Iterable[tuple[str, str]]) -> dict[str, Counter[str]]:
    """Return the frequency of each term in each field."""
    frequencies: dict[str, Counter[str]] = {}
    for field, text in texts:
        once = {*name_terms(text), *joined(text)} if field == "name" else terms(text)
        frequencies.setdefault(field, Counter()).update(once)
    return frequencies


def documents(content: Content, groups: Sequence[int]) -> list[dict[str, Counter[str]]]:
    """Return the fields of each node, with the weight of each term in them.

    Variants of a node share their texts, as a text about one describes both.
    """
    shared = [counted(shared_words(package)) for package in content.packages]
    own = [counted(own_words(node)) for node in content.nodes]
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
    return [{**shared[node.package], **fields} for node, fields in zip(content.nodes, own, strict=True)]


def mains(content: Content, groups: Sequence[int]) -> list[bool]:
    """Return whether the texts about its package describe each node (`kg.search.folding.is_main`)."""
    members = Counter((group, node.package) for node, group in zip(content.nodes, groups, strict=True))
    sizes = Counter(node.package for node in content.nodes)
    return [
        is_main(node, content.packages[node.package], members[group, node.package], sizes[node.package])
        for node, group in zip(content.nodes, groups, strict=True)
    ]


def passing(fields: Iterable[Mapping[str, Counter[str]]]) -> frozenset[str]:
    """Return the terms that only the usage sections of READMEs have: they mention other products too."""
    described: set[str] = set()
    used: set[str] = set()
    for one in fields:
        for name, counts in one.items():
            (used if name == "usage" else described).update(counts)
    return frozenset(used - described)


def worths(
    content: Content, fields: Sequence[Mapping[str, Counter[str]]], groups: Sequence[int]
) -> list[dict[str, float]]:
    """Return the score of each node for each term, from 0 to less than 1; `fields` are those of `documents`.

    This is BM25 over fields: frequencies are weighted by field and by its length, summed, then saturated.
    """
    weights, rank = lexicon().weights["fields"], lexicon().weights["rank"]
    mean = {
        name: max(1.0, sum(one.get(name, Counter()).total() for one in fields) / max(1, len(fields)))
        for name in weights
    }
    scores = []
    for one, main in zip(fields, mains(content, groups), strict=True):
        total: defaultdict[str, float] = defaultdict(float)
        for name, counts in one.items():
            length = 1 - rank["length"] + rank["length"] * max(counts.total() / mean[name], _SHORTEST)
            weight, times = weights[name] / length, rank["main"] if main and name in _PROSE else 1.0
            for term, count in counts.items():
                total[term] += weight * _OFTEN * count * times / (count * times + 1)
        scores.append({term: value / (value + rank["saturation"]) for term, value in total.items()})
    return scores
