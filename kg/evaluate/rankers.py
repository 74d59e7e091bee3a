"""What the search is compared with: well-known ways to rank nodes for a need, untuned, over the same nodes.

Each takes the documents that the search knows and gives a score for every node; nodes with none are not found. The
libraries are those of the extra `evaluate`, loaded when they are needed.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final, Protocol

from kg.errors import UsageError
from kg.evaluate.encoding import FolderModel
from kg.evaluate.matching import Patterns

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kg.evaluate.judged_needs import Need
    from kg.search.documents import Document, PackageDocument
    from kg.search.index import Index

__all__ = ["Embeddings", "FuzzyNames", "Ranker", "Subgraphs", "TfIdf", "library", "text_of_node"]

_PART: Final = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_EXTRA: Final = "evaluate"


class Ranker(Protocol):
    """A way to rank nodes."""

    name: str

    def scores(self, need: Need) -> Sequence[float]:
        """Return a score for each node, in the order of the documents; 0 and less is not found."""
        ...


def library(name: str, package: str) -> Any:
    """Return a library that not every installation has; UsageError KG724 with how to get it."""
    try:
        return import_module(name)
    except ImportError:
        hint = f"pip install 'kg-ros[{_EXTRA}]'"
        raise UsageError("KG724", f"{package} is not installed, which this comparison needs", hint=hint) from None


def text_of_node(node: Document, package: PackageDocument) -> str:
    """Return all that is known of a node in words: names, descriptions, interfaces, of its package too."""
    names = [node.name, node.executable, node.plugin, node.node_name, *node.aliases, package.name]
    ends = [text for end in node.ends for text in (end.name, end.type)]
    texts = [package.description, *(text.text for text in (*node.texts, *package.texts))]
    return " ".join(_split(one) for one in (*names, *ends, *texts) if one)


def _split(text: str) -> str:
    return " ".join(_PART.findall(text)).lower()


def _texts(index: Index) -> list[str]:
    nodes = (index.nodes[place] for place in range(index.size))
    return [text_of_node(node, index.packages[node.package]) for node in nodes]


class TfIdf:
    """Cosine of vectors weighted by term and inverse document frequency, as scikit-learn makes them unless told."""

    name = "TF-IDF"

    def __init__(self, index: Index) -> None:
        feature_extraction = library("sklearn.feature_extraction.text", "scikit-learn")
        self._vectorizer = feature_extraction.TfidfVectorizer(stop_words="english")
        self._vectors = self._vectorizer.fit_transform(_texts(index))

    def scores(self, need: Need) -> Sequence[float]:
        """Return the cosines."""
        query = self._vectorizer.transform([_split(need.query)])
        found: list[float] = (self._vectors @ query.T).toarray().ravel().tolist()
        return found


class FuzzyNames:
    """How alike the words of the need and those of the names of node and package are: rapidfuzz's token_set_ratio."""

    name = "fuzzy names"

    def __init__(self, index: Index) -> None:
        self._ratio = library("rapidfuzz.fuzz", "rapidfuzz").token_set_ratio
        nodes = (index.nodes[place] for place in range(index.size))
        self._names = [f"{_split(index.packages[node.package].name)} {_split(node.name)}" for node in nodes]

    def scores(self, need: Need) -> Sequence[float]:
        """Return the ratios from 0 to 100."""
        query = _split(need.query)
        return [self._ratio(query, name) for name in self._names]


class Subgraphs:
    """Nodes whose interface holds the one that is asked for (`kg.evaluate.matching`); the smallest interface first."""

    name = "subgraph matching"

    def __init__(self, index: Index) -> None:
        library("networkx", "networkx")
        self._patterns = Patterns([index.nodes[place] for place in range(index.size)])

    def scores(self, need: Need) -> Sequence[float]:
        """Return one by the size of the interface for each node that matches."""
        return self._patterns.scores(need.constraints)


class Embeddings:
    """Cosine of sentence embeddings by a model in a folder (`kg.evaluate.encoding`)."""

    name = "sentence embeddings"

    def __init__(self, index: Index, model: Path) -> None:
        self._model = FolderModel(model)
        self._vectors = self._model.encode(_texts(index))

    def scores(self, need: Need) -> Sequence[float]:
        """Return the cosines."""
        query = self._model.encode([need.query])[0]
        return [float(one) for one in self._vectors @ query]
