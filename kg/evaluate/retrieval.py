"""Table 11: retrieval quality of the search of `kg`, compared with other rankings of the same nodes.

The baselines are well known and untuned. Each scores every document of the search; nodes without a score are not found.
The libraries are those of the extra `evaluate`, loaded on demand.

One of them matches interfaces by subgraph monomorphism. The pattern of a need is a graph: the node, a vertex for each
required end, labelled with its role, and a vertex for the type of that end. A node's graph has the same shape for all
its ends, and matches if it contains the pattern. networkx implements that by VF2 (`GraphMatcher`); its VF2++ only tests
isomorphism of whole graphs.
"""

from __future__ import annotations

import math
import os
import random
import re
from collections import Counter
from importlib import import_module
from statistics import fmean
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import msgspec
import numpy as np

from kg.errors import Place, UsageError
from kg.evaluate.references import owner_and_name, short_name
from kg.evaluate.tables import Cell, Score, Table, bootstrap, bounds, with_paper
from kg.render.text import count
from kg.search.searching import Hit, Search

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

    from kg.search.documents import Document, PackageDocument
    from kg.search.index import Floats, Index


_MARKS: Final = ("modules.json", "config.json")
"""Marker files of a model folder: of sentence-transformers, or of a bare transformer."""
_SWITCHES: Final = {
    "HF_HUB_OFFLINE": "1",
    "TRANSFORMERS_OFFLINE": "1",
    "HF_HUB_DISABLE_PROGRESS_BARS": "1",
    "TOKENIZERS_PARALLELISM": "false",
    "TRANSFORMERS_VERBOSITY": "error",
}
_BATCH: Final = 32
_LONGEST_CAUSE: Final = 200


class FolderModel:
    """A model in a folder.

    Raises UsageError: KG704 the folder is missing, or has no model.
    """

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            hint = "Name a folder that holds a model; kg downloads none."
            raise UsageError("KG704", f"no model at {folder}: not a folder", hint=hint)
        if not any((folder / name).is_file() for name in _MARKS):
            hint = f"A folder saved by sentence-transformers holds {_MARKS[0]}, one of transformers {_MARKS[1]}."
            raise UsageError("KG704", f"the folder {folder} holds no model", hint=hint)
        self._folder = folder
        self._model: Any = None

    def encode(self, texts: Sequence[str]) -> Floats:
        """Return a vector of length 1 for each text.

        Raises UsageError: KG704 the library is not installed, or cannot load or run the model.
        """
        try:
            if self._model is None:
                self._model = _loaded(self._folder)
            encoded = self._model.encode(
                list(texts), batch_size=_BATCH, normalize_embeddings=True, show_progress_bar=False
            )
        except UsageError:
            raise
        except Exception as problem:  # the library does not declare its exceptions for damaged files
            cause = f"{type(problem).__name__}: {' '.join(str(problem).split())[:_LONGEST_CAUSE]}"
            raise self._broken(cause) from problem
        vectors = np.asarray(encoded, np.float32)
        if vectors.shape[:1] != (len(texts),) or not np.isfinite(vectors).all():
            raise self._broken("it returned no vectors, or vectors with invalid numbers")
        return vectors

    def _broken(self, cause: str) -> UsageError:
        hint = "Copy or download the folder of the model again, or leave the model out."
        return UsageError("KG704", f"the model in {self._folder} cannot be used: {cause}", hint=hint)


def _loaded(folder: Path) -> Any:
    # The libraries read these variables once, on import.
    os.environ.update(_SWITCHES)
    try:
        library = import_module("sentence_transformers")
    except ImportError:
        message = "sentence embeddings need sentence-transformers, which is not installed"
        raise UsageError("KG704", message, hint="pip install 'kg-ros[semantic]'") from None
    return library.SentenceTransformer(str(folder), local_files_only=True)


_HIGHEST: Final = 30
"""Maximum grade: higher gains exceed the range of floats."""


class Constraints(msgspec.Struct, frozen=True):
    """Required types of a node's interface, each `package/Type`."""

    subscribes: tuple[str, ...] = ()
    publishes: tuple[str, ...] = ()
    provides: tuple[str, ...] = ()
    calls: tuple[str, ...] = ()


class Judged(msgspec.Struct, frozen=True):
    """A node, and how well it meets a need: 3 is best, 0 not at all."""

    repo: str
    package: str
    node: str
    grade: int
    aliases: tuple[str, ...] | None = None


class Need(msgspec.Struct, frozen=True):
    """A query of a developer with its judgements."""

    id: str
    query: str
    relevant: tuple[Judged, ...]
    constraints: Constraints | None = None


class Ranked(msgspec.Struct, frozen=True):
    """A result of a search."""

    repository: str
    package: str
    node: str


def read_needs(path: Path) -> tuple[Need, ...]:
    """Return the needs in a file.

    Raises UsageError: KG725 the file is unreadable, empty, or has an invalid line.
    """
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise UsageError("KG725", f"the needs cannot be read: {error.strerror}", place=Place(str(path))) from None
    needs, decoder = [], msgspec.json.Decoder(Need)
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            need = decoder.decode(line)
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            place = Place(str(path), number)
            raise UsageError("KG725", f"invalid need: {error}", place=place) from None
        if any(not 0 <= one.grade <= _HIGHEST for one in need.relevant):
            raise UsageError("KG725", f"a grade is not from 0 to {_HIGHEST}", place=Place(str(path), number))
        needs.append(need)
    if not needs:
        raise UsageError("KG725", "the file has no need", place=Place(str(path)))
    return tuple(needs)


def ndcg(need: Need, ranked: Sequence[Ranked], depth: int) -> float:
    """Return the normalised discounted cumulative gain of the first `depth` nodes, the gain of a grade 2^grade - 1.

    A node matches a judgement of its repository and package by its name or an alias. A judged node counts once, one
    that nobody judged has grade 0 (Järvelin and Kekäläinen 2002; gains of Burges et al. 2005).
    """
    best = _gain(sorted((one.grade for one in need.relevant), reverse=True)[:depth])
    return _gain(list(_grades(need, ranked[:depth]))) / best if best else 0.0


def _gain(grades: Sequence[int]) -> float:
    return math.fsum((2.0**grade - 1) / math.log2(place + 2) for place, grade in enumerate(grades))


def _grades(need: Need, ranked: Sequence[Ranked]) -> Iterator[int]:
    left = list(need.relevant)
    for one in ranked:
        hit = next((each for each in left if _same(each, one)), None)
        if hit is not None:
            left.remove(hit)
        yield hit.grade if hit is not None else 0


def _same(judged: Judged, ranked: Ranked) -> bool:
    names = {short_name(judged.node), *map(short_name, judged.aliases or ())}
    same_package = judged.package == ranked.package and owner_and_name(judged.repo) == owner_and_name(ranked.repository)
    return same_package and short_name(ranked.node) in names


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
    """Rank by the cosine of sentence embeddings by a model in a folder (`kg.evaluate.retrieval`)."""
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
