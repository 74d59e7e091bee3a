"""Table 11: retrieval quality of the search of `kg`, compared with other rankings of the same nodes.

The baselines are well known and untuned. Each scores every document of the search; nodes without a score are not found.
The libraries are those of the extra `evaluate`, loaded on demand.

One of them matches interfaces by subgraph monomorphism. The pattern of a need is a graph: the node, a vertex for each
required end, labelled with its role, and a vertex for the type of that end. A node's graph has the same shape for all
its ends, and matches if it contains the pattern. networkx implements that by VF2 (`GraphMatcher`); its VF2++ only tests
isomorphism of whole graphs.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from importlib import import_module
from statistics import fmean
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from kg.errors import UsageError
from kg.evaluate.encoding import FolderModel
from kg.evaluate.intervals import bootstrap, bounds
from kg.evaluate.judged_needs import Constraints, Need, Ranked, ndcg
from kg.evaluate.tables import Cell, Score, Table, with_paper
from kg.render.text import count
from kg.search.searching import Hit, Search

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    from kg.search.documents import Document, PackageDocument
    from kg.search.index import Index

_DEPTHS: Final = (1, 5)
_OURS: Final = "kg search"
_ROUNDS: Final = 2000

_PART: Final = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")

_ROLES: Final = {
    "subscribes": ("subscribes",),
    "publishes": ("publishes",),
    "provides": ("services", "action_servers"),
    "calls": ("clients", "action_clients"),
}
"""Kinds of constraints by the roles of matching ends."""
_KINDS: Final = {role: kind for kind, roles in _ROLES.items() for role in roles}


class Patterns:
    """The interfaces of nodes as graphs."""

    def __init__(self, nodes: Sequence[Document]) -> None:
        self._ends = [
            [(_KINDS[end.role], end.type) for end in node.ends if end.type and end.role in _KINDS] for node in nodes
        ]
        self._counts = [Counter(ends) for ends in self._ends]
        self._graphs: dict[int, Any] = {}

    def scores(self, constraints: Constraints | None) -> list[float]:
        """Return a score for each node by its number of ends if it matches, else 0; no constraints, no match."""
        wanted = [(kind, type_) for kind in _ROLES for type_ in getattr(constraints, kind, ())]
        if not wanted:
            return [0.0] * len(self._ends)
        pattern, counts = _graph(wanted), Counter(wanted)
        return [self._score(place, pattern, counts) for place in range(len(self._ends))]

    def _score(self, place: int, pattern: Any, wanted: Counter[tuple[str, str]]) -> float:
        # Counting excludes most nodes without a search.
        if any(self._counts[place][end] < number for end, number in wanted.items()):
            return 0.0
        from networkx.algorithms.isomorphism import (  # noqa: PLC0415 - an extra
            GraphMatcher,
            categorical_node_match,
        )

        if place not in self._graphs:
            self._graphs[place] = _graph(self._ends[place])
        matcher = GraphMatcher(self._graphs[place], pattern, categorical_node_match("label", None))
        return 1 / len(self._ends[place]) if matcher.subgraph_is_monomorphic() else 0.0


def _graph(ends: Iterable[tuple[str, str]]) -> Any:
    from networkx import Graph  # noqa: PLC0415 - an extra

    graph = Graph()
    graph.add_node("node", label="node")
    for number, (kind, type_) in enumerate(ends):
        graph.add_node(number, label=kind)
        graph.add_node(type_, label=type_)
        graph.add_edge("node", number)
        graph.add_edge(number, type_)
    return graph


Ranker: TypeAlias = "Callable[[Need], Sequence[float]]"
"""A way to rank nodes: a score for each, in the order of the documents; 0 and less is not found."""


def library(name: str, package: str) -> Any:
    """Return an optional library; UsageError KG724 with how to install it."""
    try:
        return import_module(name)
    except ImportError:
        hint = "pip install 'kg-ros[evaluate]'"
        raise UsageError("KG724", f"{package} is not installed, which this comparison needs", hint=hint) from None


def text_of_node(node: Document, package: PackageDocument) -> str:
    """Return all texts about a node: names, descriptions and interfaces, including those of its package."""
    names = [node.name, node.executable, node.plugin, node.node_name, *node.aliases, package.name]
    ends = [text for end in node.ends for text in (end.name, end.type)]
    texts = [package.description, *(text.text for text in (*node.texts, *package.texts))]
    return " ".join(_split(one) for one in (*names, *ends, *texts) if one)


def _split(text: str) -> str:
    return " ".join(_PART.findall(text)).lower()


def _texts(index: Index) -> list[str]:
    nodes = (index.nodes[place] for place in range(index.size))
    return [text_of_node(node, index.packages[node.package]) for node in nodes]


def _tf_idf(index: Index) -> Ranker:
    """Rank by the cosine of vectors weighted by term and inverse document frequency, as scikit-learn makes them."""
    vectorizer = library("sklearn.feature_extraction.text", "scikit-learn").TfidfVectorizer(stop_words="english")
    vectors = vectorizer.fit_transform(_texts(index))
    return lambda need: (vectors @ vectorizer.transform([_split(need.query)]).T).toarray().ravel().tolist()


def _fuzzy_names(index: Index) -> Ranker:
    """Rank by how alike the words of the need and those of node and package are: rapidfuzz's token_set_ratio."""
    ratio = library("rapidfuzz.fuzz", "rapidfuzz").token_set_ratio
    nodes = (index.nodes[place] for place in range(index.size))
    names = [f"{_split(index.packages[node.package].name)} {_split(node.name)}" for node in nodes]
    return lambda need: [ratio(_split(need.query), name) for name in names]


def _subgraphs(index: Index) -> Ranker:
    """Rank the nodes whose interface holds the one that is asked for; the smallest interface first."""
    library("networkx", "networkx")
    patterns = Patterns([index.nodes[place] for place in range(index.size)])
    return lambda need: patterns.scores(need.constraints)


def embeddings(index: Index, model: Path) -> Ranker:
    """Rank by the cosine of sentence embeddings by a model in a folder (`kg.evaluate.encoding`)."""
    encode = FolderModel(model).encode
    vectors = encode(_texts(index))
    return lambda need: [float(one) for one in vectors @ encode([need.query])[0]]


def retrieval(search: Search, needs: Sequence[Need], model: Path | None = None) -> Table:
    """Return the table: NDCG of each ranking, and the gain of ours over it, with 95 % bootstrap intervals.

    Differences are paired: both rankings answer the same resampled needs. The relative one is the difference of the
    means divided by the mean of the other ranking.

    Raises UsageError: KG724 a library of the extra `evaluate` is missing, KG704 an unusable model.
    """
    index = search.index
    rankers = {
        "TF-IDF": _tf_idf(index),
        "fuzzy names": _fuzzy_names(index),
        "subgraph matching": _subgraphs(index),
        **({} if model is None else {"sentence embeddings": embeddings(index, model)}),
    }
    ranked = {name: [_ranked(search, ranker, need) for need in needs] for name, ranker in rankers.items()}
    ranked[_OURS] = [_hits(search, need) for need in needs]
    rows = tuple(
        row
        for depth in _DEPTHS
        for row in _rows(
            depth,
            {
                name: [ndcg(need, nodes, depth) for need, nodes in zip(needs, lists, strict=True)]
                for name, lists in ranked.items()
            },
        )
    )
    columns = ("method", "measure", "mean", "kg search above it", "relative")
    notes = (
        f"{count(len(needs), 'need')}, {count(search.index.size, 'node')}; 95 % bootstrap intervals, of pairs.",
        "Other ways are untuned; copies of a node are folded for all.",
    )
    return with_paper(Table("search", "How well nodes are found", columns, rows, notes), ("method", "measure"))


def _hits(search: Search, need: Need) -> list[Ranked]:
    hits = search.find(need.query, limit=max(_DEPTHS)).hits
    return [Ranked(hit.package.repository, hit.package.name, hit.name) for hit in hits]


def _ranked(search: Search, ranker: Ranker, need: Need) -> list[Ranked]:
    """Return the best nodes by score, the best of copies and variants; ties in the index's order."""
    index = search.index
    scores = np.asarray(ranker(need))
    chosen: dict[int, int] = {}
    for place in np.lexsort((index.order, -scores)).tolist():
        if scores[place] <= 0 or len(chosen) == max(_DEPTHS):
            break
        chosen.setdefault(int(index.group[place]), place)
    nodes = [index.nodes[place] for place in chosen.values()]
    hits = (Hit(0, 0.0, node, index.packages[node.package], (), ()) for node in nodes)
    return [Ranked(hit.package.repository, hit.package.name, hit.name) for hit in hits]


def _rows(depth: int, values: dict[str, list[float]]) -> list[tuple[Cell, ...]]:
    ours = values[_OURS]
    rows: list[tuple[Cell, ...]] = []
    for name, theirs in values.items():
        score = Score(fmean(theirs), bootstrap(theirs))
        above: tuple[Cell, Cell] = (None, None) if name == _OURS else _compared(ours, theirs)
        rows.append((name, f"NDCG@{depth}", score, *above))
    return rows


def _compared(ours: Sequence[float], theirs: Sequence[float]) -> tuple[Cell, Cell]:
    """Return the difference of the means and the relative one; None relative to zero."""
    differences = [one - other for one, other in zip(ours, theirs, strict=True)]
    difference = Score(fmean(differences), bootstrap(differences), signed=True)
    if not fmean(theirs):
        return difference, None
    chance = random.Random(0)  # noqa: S311 - no secret
    pairs = list(zip(differences, theirs, strict=True))
    drawn = (chance.choices(pairs, k=len(pairs)) for _ in range(_ROUNDS))
    sums = [(sum(one for one, _ in each), sum(other for _, other in each)) for each in drawn]
    ratios = bounds(one / other for one, other in sums if other)
    return difference, Score(fmean(differences) / fmean(theirs), ratios, signed=True)
