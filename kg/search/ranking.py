"""The worth of each node for a need: a weighted sum, whose parts are the reasons that hits give.

    worth = (text + wishes) * prior

`text` sums BM25 over the wordings of the need, each by the best of its alternatives. A wish adds its weight times
its rarity to the nodes that have it. The prior marks down what is rarely meant: tests, examples, what is deprecated.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.search.marking import MARKED_DOWN

if TYPE_CHECKING:
    from kg.search.index import Floats, Index
    from kg.search.needs import Alternative, Need, Wish, Wording

__all__ = ["WEIGHTS", "prior", "scores", "wish_rows", "wording_scores"]

WEIGHTS: Final = {
    "subscribes": 0.5,
    "publishes": 0.5,
    "uses": 0.3,
    "hardware": 0.3,
    "function": 0.1,
    "capability": 0.1,
}
"""What a wish is worth, for each unit of its rarity."""
_RAREST: Final = 4.0
_PHRASE: Final = 0.5
"""What each further word of a phrase adds to the worth of its first."""
_LIBRARY: Final = 0.8
_DEPRECATED: Final = 0.9


def scores(index: Index, need: Need) -> Floats:
    """Return the worth of each node, zero for those that a strict wish leaves out."""
    total = np.zeros(index.size, np.float32)
    for wording in need.wordings:
        total += wording_scores(index, wording)
    for wish in need.wishes:
        weight = WEIGHTS.get(wish.kind, 0.0)
        if weight and not wish.strict:
            rows = wish_rows(index, wish)
            total[rows] += weight * _rarity(index, len(rows))
    asked = {term for wording in need.wordings for one in wording.alternatives for term in one.terms}
    total *= prior(index, frozenset(asked))
    for wish in need.wishes:
        if wish.strict:
            kept = np.zeros(index.size, bool)
            kept[wish_rows(index, wish)] = True
            total = np.where(kept, total + 1, 0).astype(np.float32)
    return total


def wording_scores(index: Index, wording: Wording) -> Floats:
    """Return what a wording adds to the worth of each node."""
    own = wording.alternatives[0]
    best = _mean(index, own)
    for other in wording.alternatives[1:]:
        best = np.maximum(best, other.weight * _together(index, other))
    return best * np.float32(1 + _PHRASE * (len(own.terms) - 1))


def wish_rows(index: Index, wish: Wish) -> np.ndarray:
    """Return the nodes that have what is wished for."""
    columns = [index.features.rows_of(feature) for feature in wish.features]
    return np.unique(np.concatenate(columns)) if columns else np.zeros(0, np.int32)


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
    return found
