"""A complete search: the index of the current store, the need, the hits with their reasons."""

from __future__ import annotations

import textwrap
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.graph.texts import SENTENCE_END
from kg.holes import anonymous
from kg.lazily import lazily
from kg.search import cache
from kg.search.fields import own_words
from kg.search.lexicon import lexicon
from kg.search.names import Names, wishes
from kg.search.needs import Need, parse
from kg.search.ranking import fits, gain, scores, share
from kg.search.words import terms

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.search.documents import Document, PackageDocument, Text
    from kg.search.index import Index
    from kg.search.needs import Wish
    from kg.store.embedded import EmbeddedStore
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    from kg.search.index import build
    from kg.search.reading import read


_VERBS: Final = {
    "publishes": "publishes",
    "subscribes": "subscribes",
    "services": "provides the service",
    "clients": "calls the service",
    "action_servers": "provides the action",
    "action_clients": "calls the action",
}
_ROLES: Final = {"services": ("services", "action_servers"), "calls": ("clients", "action_clients")}
_KINDS: Final = {
    "comment": "a comment says",
    "docstring": "its docstring says",
    "manifest": "its package says",
    "readme": "a page says",
    "usage": "a page says",
    "launch": "a launch file says",
    "wiki": "its documentation says",
    "plugin": "its description says",
}
_CLASSES: Final = {"hardware": "works with {}", "function": "is for {}", "capability": "can {}"}
_EXCERPT: Final = 90  # maximum number of characters of a text in a reason
_MORE: Final = " …"


@dataclass(frozen=True, slots=True)
class Reason:
    """A part of a node's score in words; `path` and `line` are relative to its repository, None without a line."""

    text: str
    weight: float
    path: str | None = None
    line: int | None = None

    def __str__(self) -> str:
        return self.text if self.path is None else f"{self.text} at {self.path}:{self.line}"


def reasons(index: Index, need: Need, place: int, limit: int) -> tuple[Reason, ...]:
    """Return up to `limit` reasons for the score of the node at an index, the most important first."""
    node = index.nodes[place]
    package = index.packages[node.package]
    weights = _weights(index, need, place)
    candidates = [*_of_wishes(index, need.wishes, weights, node, package), *_of_words(weights, node, package)]
    candidates.sort(key=lambda one: (-one.weight, one.text))
    seen: dict[str, Reason] = {}
    for one in candidates:
        # `named scan` and `named scan.py` are the same reason.
        seen.setdefault("named" if one.text.startswith("named ") else one.text, one)
    return tuple(seen.values())[:limit]


def _weights(index: Index, need: Need, place: int) -> dict[str, float]:
    """Return the score of each term of the need for a node."""
    weights: dict[str, float] = {}
    for wording in need.wordings:
        part = share(index, need, wording)
        for one in wording.alternatives:
            for term in one.terms:
                value = part * one.weight * index.text.value(term, place)
                weights[term] = max(value, weights.get(term, 0.0))
    return {term: value for term, value in weights.items() if value > 0}


def _of_wishes(
    index: Index, wishes: Iterable[Wish], weights: Mapping[str, float], node: Document, package: PackageDocument
) -> Iterator[Reason]:
    for wish in wishes:
        features = set(wish.features)
        weight = gain(index, wish) + (1.0 if wish.strict else 0.0)
        for end in node.ends:
            if end.role in _ROLES.get(wish.kind, (wish.kind,)) and f"{end.role}:{end.type}" in features:
                words = terms(f"{anonymous(end.name or '')} {(end.type or '').rpartition('/')[2]}")
                words_weight = sum(weights.get(term, 0.0) for term in set(words))
                yield Reason(f"{_VERBS[end.role]} {end.type}", weight + words_weight / 2, end.path, end.line)
                break
        labels = {"hardware": node.hardware, "function": node.functions, "capability": node.capabilities}
        if wish.kind in labels:
            matching = [label for label in labels[wish.kind] if f"{wish.kind}:{label}" in features]
            matching = matching or ([wish.features[0].partition(":")[2]] if wish.strict else [])
            yield from (Reason(_CLASSES[wish.kind].format(label), weight) for label in matching[:1])
        if wish.strict and wish.kind == "license":
            yield Reason(f"licence {' and '.join(package.licenses)}", 0.5, package.path, 1)


def _of_words(weights: Mapping[str, float], node: Document, package: PackageDocument) -> Iterator[Reason]:
    """Yield a reason for each place that contains words of the need, with its score."""
    fields = lexicon().weights["fields"]

    def worth(text: str, field: str) -> float:
        return sum(weights.get(term, 0.0) for term in set(terms(text))) * min(1.0, fields[field])

    for field, text in own_words(node):
        if field in {"name", "plugin"} and (value := worth(text, field)):
            yield Reason(f"named {text}", value, node.path, node.line)
    yield from _best(node.texts, lambda text, _: worth(text, "text"))
    others = [text for text in package.texts if text.kind != "manifest"]
    yield from _best(others, lambda text, kind: worth(text, "usage" if kind == "usage" else "readme"))
    if value := worth(package.name, "package"):
        yield Reason(f"in the package {package.name}", value, package.path, 1)
    if package.description and (value := worth(package.description, "manifest")):
        excerpt = _excerpt(package.description, lambda one: worth(one, "manifest"))
        yield Reason(f"its package says “{excerpt}”", value, package.path, 1)
    for end in node.ends:
        if value := worth(f"{anonymous(end.name or '')} {(end.type or '').rpartition('/')[2]}", "interface"):
            yield Reason(f"{_VERBS[end.role]} {end.name or end.type}", value * 0.5, end.path, end.line)
    for name, description in node.parameters:
        if value := worth(f"{name} {description or ''}", "parameter"):
            yield Reason(f"has the parameter {name}", value * 0.5)


def _best(texts: Iterable[Text], worth: Callable[[str, str], float]) -> Iterator[Reason]:
    valued = [(worth(text.text, text.kind), text) for text in texts]
    value, best = max(valued, key=lambda one: one[0], default=(0.0, None))
    if best is not None and value > 0:
        excerpt = _excerpt(best.text, lambda text: worth(text, best.kind))
        yield Reason(f"{_KINDS.get(best.kind, 'it says')} “{excerpt}”", value, best.path, best.line)


def _excerpt(text: str, worth: Callable[[str], float]) -> str:
    """Return the beginning of the sentence whose beginning is worth the most, the first of equals."""
    text = " ".join(text.split())
    begins = [0, *(match.end() for match in SENTENCE_END.finditer(text))]
    shown = {at: textwrap.shorten(text[at:], _EXCERPT + len(_MORE), placeholder=_MORE) for at in begins}
    best = max(begins, key=lambda at: worth(shown[at]))
    return f"… {shown[best]}" if best else shown[best]


_REASONS = 5
_DIGITS = 4  # scores are compared to so many decimals, so that sums of floats in another order change nothing


@dataclass(frozen=True, slots=True)
class Hit:
    """A node that was found; `others` contains its variants and copies, best first."""

    rank: int
    score: float
    node: Document
    package: PackageDocument
    why: tuple[Reason, ...]
    others: tuple[tuple[PackageDocument, Document], ...]
    fits: bool = True

    @property
    def name(self) -> str:
        """Display name: for a component its class, as launch files load it."""
        if self.node.kind == "component" and self.node.plugin:
            return self.node.plugin.rpartition("::")[2].rpartition("/")[2]
        return self.node.name


@dataclass(frozen=True, slots=True)
class Answer:
    """The hits of a need as parsed; `total` is the number of all hits.

    `fits` is false if the hits are only the nearest ones: none covers enough of the need's information.
    """

    need: Need
    hits: tuple[Hit, ...]
    total: int
    fits: bool = True


class Search:
    """Searches in one index; long-running processes reuse it."""

    def __init__(self, index: Index) -> None:
        self.index = index
        self.names = Names(index.features.names, index.concepts, index.text.names.keys() - index.passing)

    def find(self, text: str, filters: Mapping[str, Sequence[str]] | None = None, limit: int = 10) -> Answer:
        """Return the best hits for a need in words, restricted by filters (`kg.search.names`).

        Raises UsageError: KG701, KG702, KG703 for a name in a filter that no node has.
        """
        given = wishes(filters or {}, self.names)
        need = parse(text, self.names)
        need = Need(need.text, need.wordings, (*given, *need.wishes))
        worth = np.round(scores(self.index, need), _DIGITS)
        places = np.flatnonzero(worth > 0)
        places = places[np.lexsort((self.index.order[places], -worth[places]))]
        groups: dict[int, list[int]] = {}
        for place in places.tolist():
            groups.setdefault(int(self.index.group[place]), []).append(place)
        chosen = list(groups.values())[:limit]
        fitting = fits(self.index, need, [members[0] for members in chosen])
        hits = [self._hit(rank, members, worth, need) for rank, members in enumerate(chosen, 1)]
        return Answer(need, tuple(replace(hit, fits=fitting) for hit in hits), len(groups), fitting)

    def _hit(self, rank: int, members: Sequence[int], worth: Any, need: Need) -> Hit:
        place, *others = members
        node = self.index.nodes[place]
        return Hit(
            rank,
            float(worth[place]),
            node,
            self.index.packages[node.package],
            reasons(self.index, need, place, _REASONS),
            tuple((self.index.packages[other.package], other) for other in map(self.index.nodes.__getitem__, others)),
        )


def open_search(store: EmbeddedStore, indexing: Callable[[], None] | None = None) -> Search:
    """Return the search in the current generation; its index is read from the store's cache, or built and cached.

    `indexing` is called before it is built, which takes seconds in a large store.

    Raises StoreError: KG301 for a store without data, KG303 for a damaged one.
    """
    generation = store.layout.current()
    index = None if generation is None else cache.load(store.layout.cache, str(generation))
    if index is None:
        if indexing is not None:
            indexing()
        with store.read() as snapshot:
            index = _indexed(snapshot, store.layout.cache)
    return Search(index)


def search_of(snapshot: EmbeddedSnapshot, folder: Path) -> Search:
    """Return the search in an open snapshot; `folder` is the cache of its store."""
    index = cache.load(folder, snapshot.identity)
    return Search(_indexed(snapshot, folder) if index is None else index)


def _indexed(snapshot: EmbeddedSnapshot, folder: Path) -> Index:
    """Return the index of a snapshot, built now and cached."""
    with cache.alone(folder):
        # Another process may have built it while this one waited.
        index = cache.load(folder, snapshot.identity) or build(read(snapshot))
        # In a read-only store, the index is built each time.
        with suppress(OSError):
            cache.save(folder, snapshot.identity, index)
    return index


def hit_object(hit: Hit) -> dict[str, Any]:
    """Return a hit as in `kg search --json`."""
    node, package = hit.node, hit.package
    return {
        "rank": hit.rank,
        "score": round(hit.score, _DIGITS),
        "repository": package.repository,
        "package": package.name,
        "node": hit.name,
        "name": node.name,
        "kind": node.kind,
        "ros": node.ros or package.ros,
        "executable": node.executable,
        "plugin": node.plugin,
        "file": node.path,
        "line": node.line,
        "fits": hit.fits,
        "why": [str(reason) for reason in hit.why],
        "reasons": [
            {"text": one.text, "weight": round(one.weight, 2), "file": one.path, "line": one.line} for one in hit.why
        ],
        "also": [
            {"repository": other.repository, "package": other.name, "node": one.name, "kind": one.kind}
            for other, one in hit.others
        ],
    }
