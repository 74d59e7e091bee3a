"""The index: the score of each term for each node, and the nodes of each feature.

BM25 over fields gives the score of a term (`kg.search.fields`). A feature is the target of a filter, such as
`subscribes:sensor_msgs/LaserScan` or `hardware:camera`. Both are sparse columns over the nodes.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from kg.search.fields import documents, passing, worths
from kg.search.folding import bare_name, groups, order
from kg.search.marking import marks
from kg.search.neighbours import neighbours
from kg.search.words import name_terms

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from typing import TypeAlias

    from numpy.typing import NDArray

    from kg.search.documents import Document, PackageDocument
    from kg.search.reading import Concept, Content

    Floats: TypeAlias = NDArray[np.float32]
    Places: TypeAlias = NDArray[np.int32]

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
    in launch files. `near` and `shares` are those of `kg.search.neighbours`. `passing` contains the terms of `text`
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
    common: Counter[str] = Counter(term for terms in named for term in terms)
    for terms in named:
        rarity = {term: math.log(1 + len(nodes) / common[term]) for term in terms}
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
