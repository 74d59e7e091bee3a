"""Nearest nodes of each node: those with the most characteristic words in common.

Nodes that are alike tend to meet the same needs (Jardine and van Rijsbergen 1971, "The use of hierarchic clustering in
information retrieval"), so the score of a node is raised by those of its neighbours (`kg.search.ranking`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kg.search.index import Columns, Floats, Places

NEIGHBOURS: Final = 20
_WORDS: Final = 20  # so many words characterize a node
_SHARED: Final = 400  # a word that more nodes have characterizes none
_DIGITS: Final = 4  # similarities are compared to so many decimals, so that the order of sums changes nothing


def neighbours(text: Columns, group: Places) -> tuple[Places, Floats]:
    """Return the nearest nodes of each node and their shares, which sum up to one; both have `NEIGHBOURS` columns.

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
