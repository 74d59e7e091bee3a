"""A complete search: the index of the current store, the need, the ranking of nodes, the hits with their reasons."""

from __future__ import annotations

import math
import textwrap
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.graph.texts import SENTENCE_END
from kg.holes import anonymous
from kg.lazily import lazily
from kg.search import cache
from kg.search.index import MARKS, TESTS, own_words
from kg.search.names import Names, wishes
from kg.search.needs import Need, parse
from kg.search.words import lexicon, terms

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.search.documents import Document, PackageDocument, Text
    from kg.search.index import Floats
    from kg.search.needs import Alternative, Wish, Wording
    from kg.store.embedded import EmbeddedStore
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    from kg.search.index import Columns, Index, build
    from kg.search.reading import read


_RAREST: Final = 2.0
_ABOUT: Final = ("ros", "license", "kind", "package")  # filters without information about what a node does
_FILTERED: Final = 0.01  # what fulfils the filters is a hit, whatever else the words say


def scores(index: Index, need: Need) -> Floats:
    """Return the score of each node, zero for those excluded by a strict wish."""
    total = covered(index, need) + np.float32(_rank("named")) * _named(index, need) + _wished(index, need)
    requested = {term for wording in need.wordings for one in wording.alternatives for term in one.terms}
    total *= prior(index, frozenset(requested))
    strict = [wish for wish in need.wishes if wish.strict]
    if strict:
        fulfilled = np.zeros(index.size, np.int32)
        for wish in strict:
            fulfilled[wish_rows(index, wish)] += 1
        total = np.where(fulfilled == len(strict), total + _FILTERED, 0)
    alike = np.einsum("ij,ij->i", index.shares, total[index.near])
    return np.where(total > 0, total + _rank("alike") * alike, 0).astype(np.float32)


def covered(index: Index, need: Need) -> Floats:
    """Return the share of the need's information that each node has, from 0 to 1."""
    total = np.zeros(index.size, np.float32)
    for wording in need.wordings:
        total += np.float32(share(index, need, wording)) * wording_scores(index, wording)
    return total


def fits(index: Index, need: Need, places: Sequence[int]) -> bool:
    """Return whether one of the best nodes covers enough of a need's information (`least` in `ontology/search.toml`).

    Unknown words reduce the coverage by their share, unknown names by twice theirs, because a need is about what it
    names. A node that fulfils a filter for its interface, hardware or function fits, and so does any if the need has no
    words.
    """
    if not need.wordings or not places or any(wish.strict and wish.kind not in _ABOUT for wish in need.wishes):
        return True
    strange = (share(index, need, one) * (1 + one.name) for one in need.wordings if one.unknown)
    evidence = float(covered(index, need)[list(places)].max()) * max(0.0, 1 - sum(strange))
    return evidence >= _rank("least")


def share(index: Index, need: Need, wording: Wording) -> float:
    """Return the share of a wording in the information of its need."""
    return _information(index, need, wording) / sum(_information(index, need, one) for one in need.wordings)


def _information(index: Index, need: Need, wording: Wording) -> float:
    """Return the information of a wording; an unknown ordinary word has less than an unknown name."""
    if not wording.unknown or wording.name:
        return wording.weight * index.information(_spelling(index, wording).terms[0])
    amounts = [index.information(_spelling(index, one).terms[0]) for one in need.wordings if not one.unknown]
    most = index.information(wording.alternatives[0].terms[0])
    mean = sum(amounts) / len(amounts) if amounts else most
    return wording.weight * (most + _rank("ordinary") * (mean - most))


def _spelling(index: Index, wording: Wording) -> Alternative:
    """Return the spelling of a wording that nodes have: `influxdb` if none has `influx`.

    A word that no node has is as rare as the first thing that it stands for.
    """
    own = [one for one in wording.alternatives if one.weight == 1.0]
    others = () if wording.unknown else wording.alternatives
    return next((one for one in (*own, *others) if one.terms[0] in index.text.names), own[0])


def wording_scores(index: Index, wording: Wording) -> Floats:
    """Return the score of a wording for each node, from 0 to 1.

    A synonym that is more frequent than the word itself has less information, and its score is lowered accordingly.
    What an everyday wording stands for counts by the rarity of the word itself: nodes have words of the field.
    """
    own = index.information(_spelling(index, wording).terms[0])
    rarity = index.information(wording.alternatives[0].terms[0]) / index.most_information
    best = np.zeros(index.size, np.float32)
    for one in wording.alternatives:
        columns = [index.text.dense(term, index.size) for term in one.terms]
        amount = max(index.information(term) for term in one.terms)
        weight = one.weight * min(1.0, amount / own) * (rarity if one.loose else 1.0)
        best = np.maximum(best, np.float32(weight) * np.min(columns, axis=0))
    return best


def _named(index: Index, need: Need) -> Floats:
    total = np.zeros(index.size, np.float32)
    for wording in need.wordings:
        total += _name_shares(index.names, index.size, wording)
    return np.minimum(total, 1) ** 2


def _wished(index: Index, need: Need) -> Floats:
    total = np.zeros(index.size, np.float32)
    for wish in need.wishes:
        if not wish.strict and (added := gain(index, wish)):
            total[wish_rows(index, wish)] += added
    return total


def gain(index: Index, wish: Wish) -> float:
    """Return the score that a wish adds to a node that fulfils it; rare features add more."""
    weight = lexicon().weights["wishes"].get(wish.kind, 0.0)
    return weight * _rarity(index, len(wish_rows(index, wish))) if weight else 0.0


def wish_rows(index: Index, wish: Wish) -> np.ndarray:
    """Return the nodes that fulfil a wish."""
    columns = [index.features.rows_of(feature) for feature in wish.features]
    return np.unique(np.concatenate(columns)) if columns else np.zeros(0, np.int32)


def _name_shares(columns: Columns, size: int, wording: Wording) -> Floats:
    """Return for each node the largest share of its name covered by an alternative of a wording."""
    best = np.zeros(size, np.float32)
    for one in wording.alternatives:
        part = sum((columns.dense(term, size) for term in one.terms), np.zeros(size, np.float32))
        best = np.maximum(best, np.float32(one.weight) * part)
    return best


def _rarity(index: Index, count: int) -> float:
    """Return the rarity of a feature, from 0 to 1."""
    return min(_RAREST, math.log(1 + index.size / (count + 1))) / _RAREST


def _rank(name: str) -> float:
    return lexicon().weights["rank"][name]


def prior(index: Index, requested: frozenset[str]) -> Floats:
    """Return the score factor of each node independent of the need, but `requested` words lower no node."""
    down = lexicon().weights["down"]
    factors = 1 + np.float32(_rank("started")) * index.started
    for words, lost in ((TESTS, down["test"]), (MARKS - TESTS, down["mark"])):
        marked = np.zeros(index.size, np.bool_)
        for word in words - requested:
            marked[index.features.rows_of(f"mark:{word}")] = True
        factors[marked] *= 1 - lost
    factors[index.features.rows_of("untold:")] *= 1 - down["untold"]
    return factors.astype(np.float32)


_VERBS: Final = {
    "publishes": "publishes",
    "subscribes": "subscribes",
    "services": "offers the service",
    "clients": "calls the service",
    "action_servers": "offers the action",
    "action_clients": "calls the action",
}
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
            if f"{end.role}:{end.type}" in features:
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
