"""Score of each node for a need, from 0 to about 1; its parts are the reasons that hits show.

    worth = (covered + named + wishes) * prior
    score = worth + alike * mean worth of the nearest nodes

`covered` is the share of the need's information that the node covers: each word has the information of its rarity, less
in an aside, times its score in the node (`kg.search.fields`) for the best of its alternatives.
`named` is the requested share of the node's name: of two nodes with "voxel grid" in the name, the one without other
words wins. A wish adds its weight times its rarity to the nodes that fulfil it. The prior lowers nodes that are rarely
wanted, tests and examples, and prefers nodes started by launch files. Neighbours (`kg.search.index`) raise a node
that says less than others like it. The numbers are in `ontology/search.toml`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.search.index import MARKS, TESTS
from kg.search.lexicon import lexicon

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.search.index import Columns, Floats, Index
    from kg.search.needs import Alternative, Need, Wish, Wording

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
        total += _best(index.names, index.size, wording)
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


def _best(columns: Columns, size: int, wording: Wording) -> Floats:
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
