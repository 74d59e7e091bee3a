"""The worth of each node for a need: a weighted sum, whose parts are the reasons that hits give.

    worth = (text + name + wishes + meaning) * prior

`text` sums BM25 over the wordings of the need, each by the best of its alternatives. `name` is how much of the node's
name was asked for: of two nodes with a voxel grid the one that has nothing else in its name. A wish adds its weight
times its rarity to the nodes that have it. `meaning` is there with a model of sentence embeddings only. The prior marks
down what is rarely meant: tests, examples, what is deprecated.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.search.lexicon import lexicon
from kg.search.marking import MARKED_DOWN

if TYPE_CHECKING:
    from kg.search.index import Columns, Floats, Index
    from kg.search.needs import Alternative, Need, Wish, Wording

__all__ = ["WEIGHTS", "gain", "meant", "prior", "scores", "wish_rows", "wording_scores"]

WEIGHTS: Final = {
    "subscribes": 0.5,
    "publishes": 0.7,
    "uses": 0.3,
    "hardware": 0.3,
    "function": 0.1,
    "capability": 0.15,
}
"""What a wish is worth, for each unit of its rarity."""
_OPEN: Final = ("subscribes", "publishes")
_OPEN_SHARE: Final = 0.7
"""What a topic of a type that is not known, or any type, is worth beside one of the type wished for."""
_COVERAGE: Final = 0.5
_PRESENT: Final = 0.5
"""A wording is there where it is worth this share of what it is worth where it is worth most."""
_TINY: Final = 1e-6
_NAMED: Final = 3.0
"""What it is worth that all of a node's name was asked for."""
_RAREST: Final = 2.0
_PHRASE: Final = 0.25
"""What each further word of a phrase adds to the worth of its first."""
_LIBRARY: Final = 0.8
_DEPRECATED: Final = 0.9
_UNTOLD: Final = 0.9
"""What a node is worth that nobody wrote a sentence about."""


def scores(index: Index, need: Need, likeness: Floats | None = None) -> Floats:
    """Return the worth of each node, zero for those that a strict wish leaves out.

    `likeness` has the cosine of the need to each node (`kg.search.meaning`); without it meaning counts nothing.
    """
    total = _text(index, need) + _NAMED * _named(index, need) + _wished(index, need)
    if likeness is not None:
        total += meant(likeness)
    asked = {term for wording in need.wordings for one in wording.alternatives for term in one.terms}
    total *= prior(index, frozenset(asked))
    strict = [wish for wish in need.wishes if wish.strict]
    if not strict:
        return total
    kept = np.zeros(index.size, np.int32)
    for wish in strict:
        kept[wish_rows(index, wish)] += 1
    # What fulfils the filters is a hit, whatever else the words say.
    return np.where(kept == len(strict), total + 1, 0).astype(np.float32)


def meant(likeness: Floats) -> Floats:
    """Return what its likeness in meaning adds to the worth of each node (`[meaning]` of `ontology/search.toml`)."""
    weights = lexicon().meaning
    least = weights["least"]
    found: Floats = np.maximum(0, likeness - np.float32(least)) * np.float32(weights["weight"] / (1 - least))
    return found


def _text(index: Index, need: Need) -> Floats:
    """Return the sum over the wordings, marked down where much of the need is missing altogether."""
    total, present, most = (np.zeros(index.size, np.float32) for _ in range(3))
    for wording in need.wordings:
        found = wording_scores(index, wording)
        best = found.max(initial=0)
        total += found
        if best > 0:
            present += best * np.minimum(1, found / (_PRESENT * best))
            most += best
    return total * np.power(present / np.maximum(most, _TINY), _COVERAGE, dtype=np.float32)


def _named(index: Index, need: Need) -> Floats:
    total = np.zeros(index.size, np.float32)
    for wording in need.wordings:
        total += wording.weight * _best(index.names, index.size, wording)
    return np.minimum(total, 1) ** 2


def _wished(index: Index, need: Need) -> Floats:
    total = np.zeros(index.size, np.float32)
    for wish in need.wishes:
        if wish.kind in WEIGHTS and not wish.strict:
            rows, added = wish_rows(index, wish), gain(index, wish)
            total[rows] += added
            if wish.kind in _OPEN:
                total[np.setdiff1d(index.features.rows_of(f"{wish.kind}:"), rows)] += _OPEN_SHARE * added
    return total


def gain(index: Index, wish: Wish) -> float:
    """Return what a wish adds to the worth of a node that fulfils it: the more, the rarer that is."""
    return WEIGHTS.get(wish.kind, 0.0) * _rarity(index, len(wish_rows(index, wish)))


def wording_scores(index: Index, wording: Wording) -> Floats:
    """Return what a wording adds to the worth of each node."""
    own = wording.alternatives[0]
    best = _mean(index, own)
    for other in wording.alternatives[1:]:
        best = np.maximum(best, other.weight * _together(index, other))
    return best * np.float32(wording.weight * (1 + _PHRASE * (len(own.terms) - 1)))


def wish_rows(index: Index, wish: Wish) -> np.ndarray:
    """Return the nodes that have what is wished for."""
    columns = [index.features.rows_of(feature) for feature in wish.features]
    return np.unique(np.concatenate(columns)) if columns else np.zeros(0, np.int32)


def _best(columns: Columns, size: int, wording: Wording) -> Floats:
    """Return for each node the most that an alternative of a wording has of its name."""
    best = np.zeros(size, np.float32)
    for one in wording.alternatives:
        share = sum((columns.dense(term, size) for term in one.terms), np.zeros(size, np.float32))
        best = np.maximum(best, np.float32(one.weight) * share)
    return best


def _mean(index: Index, alternative: Alternative) -> Floats:
    total = sum((index.text.dense(term, index.size) for term in alternative.terms), np.zeros(index.size, np.float32))
    return total / np.float32(max(1, len(alternative.terms)))


def _together(index: Index, alternative: Alternative) -> Floats:
    """Return the mean worth of terms for the nodes that have all of them."""
    columns = [index.text.dense(term, index.size) for term in alternative.terms]
    if not columns:
        return np.zeros(index.size, np.float32)
    together = np.min(columns, axis=0) > 0
    return np.where(together, np.mean(columns, axis=0), 0).astype(np.float32)


def _rarity(index: Index, count: int) -> float:
    return min(_RAREST, math.log(1 + index.size / (count + 1)))


def prior(index: Index, asked: frozenset[str]) -> Floats:
    """Return what each node is worth whatever the need; words that were `asked` for mark nothing down."""
    marks = {word: factor for word, factor in MARKED_DOWN.items() if word not in asked}
    found = np.ones(index.size, np.float32)
    for word, factor in marks.items():
        found[index.features.rows_of(f"mark:{word}")] *= factor
    found[index.features.rows_of("kind:class")] *= _LIBRARY
    found[index.features.rows_of("deprecated:")] *= _DEPRECATED
    found[index.features.rows_of("untold:")] *= _UNTOLD
    return found
