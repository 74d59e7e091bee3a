"""The index: the score of each term for each node, and the nodes of each feature.

BM25 over the fields of a document gives the score of a term. A feature is the target of a filter, such as
`subscribes:sensor_msgs/LaserScan` or `hardware:camera`. Both are sparse columns over the nodes.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeAlias

import numpy as np

from kg.holes import anonymous
from kg.search.folding import bare_name, groups, is_main, order
from kg.search.words import joined, lexicon, name_terms, terms

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from kg.search.documents import Document, PackageDocument
    from kg.search.reading import Concept, Content

    Floats: TypeAlias = NDArray[np.float32]
    Places: TypeAlias = NDArray[np.int32]


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


TESTS: Final = frozenset(("test", "tester", "mock", "fake", "debug", "benchmark"))
"""Stems of words in names and folders of nodes that are for the developers of a package."""
MARKS: Final = TESTS | {"exampl", "demo", "sampl", "tutori", "simul", "rviz", "gui", "gazebo", "legaci", "old"}
"""Stems of words in names and folders of nodes that are rarely wanted unless requested."""


def marks(node: Document, package: PackageDocument) -> set[str]:
    """Return the stems that lower the rank of a node, from its name, its package and the folders of its file."""
    folders = node.path.rpartition("/")[0]
    return {term for term in terms(f"{node.name} {package.name} {folders}") if term in MARKS}


NEIGHBOURS: Final = 20
_WORDS: Final = 20  # so many words characterize a node
_SHARED: Final = 400  # a word that more nodes have characterizes none
_DIGITS: Final = 4  # similarities are compared to so many decimals, so that the order of sums changes nothing


def neighbours(text: Columns, group: Places) -> tuple[Places, Floats]:
    """Return the nearest nodes of each node and their shares, which sum up to one; both have `NEIGHBOURS` columns.

    Nearest are those with the most characteristic words in common. Nodes that are alike tend to meet the same needs
    (Jardine and van Rijsbergen 1971, "The use of hierarchic clustering in information retrieval"), so the score of a
    node is raised by those of its neighbours (`kg.search.searching`).

    Variants of a node are not its neighbours. Where a node has fewer, the rest is the node itself with a share of zero.
    """
    size = len(group)
    near = np.repeat(np.arange(size, dtype=np.int32)[:, np.newaxis], NEIGHBOURS, axis=1)
    shares = np.zeros((size, NEIGHBOURS), np.float32)
    rows, terms, weights = _characteristic(text, size)
    by_term = np.argsort(terms, kind="stable")
    starts = np.searchsorted(terms[by_term], np.arange(len(text.starts)))
    others, amounts = rows[by_term], weights[by_term]
    of_row = np.searchsorted(rows, np.arange(size + 1))
    for row in range(size):
        own = slice(of_row[row], of_row[row + 1])
        postings = [slice(starts[term], starts[term + 1]) for term in terms[own]]
        if not postings:
            continue
        found = np.concatenate([others[one] for one in postings])
        added = np.concatenate([amounts[one] * weight for one, weight in zip(postings, weights[own], strict=True)])
        alike = np.round(np.bincount(found, added, size), _DIGITS)
        places = np.flatnonzero(alike)
        places = places[group[places] != group[row]]
        places = places[np.argsort(-alike[places], kind="stable")][:NEIGHBOURS]
        near[row, : len(places)] = places
        shares[row, : len(places)] = alike[places] / alike[places].sum()
    return near, shares


def _characteristic(text: Columns, size: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Return the characteristic terms of all nodes: nodes in order, terms, and weights of unit length for each node."""
    counts = np.diff(text.starts)
    terms = np.repeat(np.arange(len(counts)), counts)
    kept = (counts[terms] > 1) & (counts[terms] <= _SHARED)
    rows, terms = text.rows[kept], terms[kept]
    weights = text.values[kept] * np.log(1 + (size - counts[terms] + 0.5) / (counts[terms] + 0.5))
    order = np.lexsort((-weights, rows))
    rows, terms, weights = rows[order], terms[order], weights[order]
    first = np.arange(len(rows)) - np.searchsorted(rows, rows) < _WORDS
    rows, terms, weights = rows[first], terms[first], weights[first]
    return rows, terms, weights / np.sqrt(np.bincount(rows, weights**2, size))[rows]


_MUCH: Final = 5.0  # the logarithm of as many starts as a node has that is used everywhere
_ENOUGH: Final = 1000


@dataclass(frozen=True, slots=True)
class Columns:
    """Sparse columns over nodes: column `i` has the nodes `rows[starts[i]:starts[i+1]]`, and values in parallel."""

    names: Mapping[str, int]
    starts: NDArray[np.int64]
    rows: Places
    values: Floats

    def rows_of(self, name: str) -> Places:
        """Return the nodes of a column, empty for a missing column."""
        place = self.names.get(name)
        return self.rows[:0] if place is None else self.rows[self.starts[place] : self.starts[place + 1]]

    def value(self, name: str, row: int) -> float:
        """Return the value of one node in a column, zero if absent."""
        rows = self.rows_of(name)
        at = int(np.searchsorted(rows, row))
        if at == len(rows) or rows[at] != row:
            return 0.0
        return float(self.values[self.starts[self.names[name]] + at])

    def dense(self, name: str, size: int) -> Floats:
        """Return the values of a column for all nodes."""
        values = np.zeros(size, np.float32)
        place = self.names.get(name)
        if place is not None:
            part = slice(self.starts[place], self.starts[place + 1])
            values[self.rows[part]] = self.values[part]
        return values


class Nodes(Protocol):
    """The documents of nodes, in order."""

    def __len__(self) -> int: ...

    def __getitem__(self, place: int) -> Document:
        """Return the document at an index."""
        ...


@dataclass(slots=True)
class Index:
    """All data of a search.

    `names` contains the share of each term in the name of a node; the shares of a name sum up to one. `group` contains
    the index of the first node of each node's group, `order` its rank among hits with equal scores, `started` its use
    in launch files. `near` and `shares` are those of `neighbours`. `passing` contains the terms of `text`
    that describe no node, but occur in the usage of a package.
    """

    packages: Sequence[PackageDocument]
    nodes: Nodes
    concepts: Sequence[Concept]
    text: Columns
    names: Columns
    features: Columns
    group: Places
    order: Places
    started: Floats
    near: Places
    shares: Floats
    passing: frozenset[str]

    @property
    def size(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def most_information(self) -> float:
        """The information of a term that no node has."""
        return self.information("")

    def information(self, term: str) -> float:
        """Return the information of a term (inverse document frequency): rare terms have more.

        A small store is treated as one with `_ENOUGH` nodes, because few nodes do not show which words are rare.
        """
        count = len(self.text.rows_of(term))
        return math.log(1 + (max(self.size, _ENOUGH) - count + 0.5) / (count + 0.5))


def build(content: Content) -> Index:
    """Return the index of the documents read from a store."""
    group = groups(content.packages, content.nodes)
    fields = documents(content, group.tolist())
    wider = {(concept.kind, concept.label): concept.wider for concept in content.concepts}
    features = (_features(node, content.packages[node.package], wider) for node in content.nodes)
    text = _columns(worths(content, fields, group.tolist()))
    return Index(
        content.packages,
        content.nodes,
        content.concepts,
        text,
        _columns(_shares(content.nodes)),
        _columns(dict.fromkeys(names, 1.0) for names in features),
        group,
        order(content.packages, content.nodes),
        _started(content.nodes, group),
        *neighbours(text, group),
        passing(fields),
    )


def _started(nodes: Sequence[Document], group: Places) -> Floats:
    """Return the use of each node in launch files, from 0 for never; variants count together."""
    total: Counter[int] = Counter()
    for node, first in zip(nodes, group.tolist(), strict=True):
        total[first] = max(total[first], node.starts)
    return np.array([math.log1p(total[first]) / _MUCH for first in group.tolist()], np.float32)


def _features(
    node: Document, package: PackageDocument, wider: Mapping[tuple[str, str], tuple[str, ...]]
) -> Iterator[str]:
    for end in node.ends:
        if end.type:
            yield f"{end.role}:{end.type}"
    for kind, labels in (("hardware", node.hardware), ("function", node.functions), ("capability", node.capabilities)):
        for label in labels:
            yield f"{kind}:{label}"
            for other in wider.get((kind, label), ()):
                yield f"{kind}:{other}"
    yield f"ros:{node.ros or package.ros}"
    yield f"kind:{node.kind}"
    yield f"package:{package.name}"
    yield from (f"mark:{word}" for word in marks(node, package))
    if not node.texts:
        yield "untold:"
    for name in package.licenses:
        yield f"license:{name}"


def _shares(nodes: Sequence[Document]) -> Iterator[dict[str, float]]:
    """Yield the share of each term in a node's name, by its rarity in names."""
    named = [set(name_terms(bare_name(node.name))) for node in nodes]
    common: Counter[str] = Counter(term for words in named for term in words)
    for words in named:
        rarity = {term: math.log(1 + len(nodes) / common[term]) for term in words}
        whole = sum(rarity.values())
        yield {term: value / whole for term, value in rarity.items()}


def _columns(nodes: Iterable[Mapping[str, float]]) -> Columns:
    """Return the columns of the values that each node has, by name."""
    by_name: defaultdict[str, list[tuple[int, float]]] = defaultdict(list)
    for place, values in enumerate(nodes):
        for name, value in values.items():
            by_name[name].append((place, value))
    names = {name: place for place, name in enumerate(sorted(by_name))}
    lists = [by_name[name] for name in names]
    starts = np.cumsum([0, *map(len, lists)], dtype=np.int64)
    rows = np.array([place for places in lists for place, _ in places], np.int32)
    return Columns(names, starts, rows, np.array([value for places in lists for _, value in places], np.float32))
