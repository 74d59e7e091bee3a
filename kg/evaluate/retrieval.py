"""Table 11: how well nodes are found for needs, by the search of `kg` and by other ways to rank them."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.evaluate.intervals import bootstrap, bounds
from kg.evaluate.judged_needs import Ranked, ndcg
from kg.evaluate.paper import beside
from kg.evaluate.rankers import Embeddings, FuzzyNames, Subgraphs, TfIdf
from kg.evaluate.tables import Score, Table
from kg.render.text import count
from kg.search.searching import Hit

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kg.evaluate.judged_needs import Need
    from kg.evaluate.rankers import Ranker
    from kg.evaluate.tables import Cell
    from kg.search.searching import Search

_DEPTHS: Final = (1, 5)
_OURS: Final = "kg search"
_ROUNDS: Final = 2000


def retrieval(search: Search, needs: Sequence[Need], model: Path | None = None) -> Table:
    """Return the table: NDCG of each way, and by how much ours is above it, with 95 % bootstrap intervals.

    The difference is of pairs: both ways answer the needs of a round. The relative one is the difference of the means
    by the mean of the other way.

    Raises:
        UsageError: KG724 when a library of the extra `evaluate` is missing, KG704 for a model that cannot be used.
    """
    rankers: list[Ranker] = [TfIdf(search.index), FuzzyNames(search.index), Subgraphs(search.index)]
    if model is not None:
        rankers.append(Embeddings(search.index, model))
    ranked = {one.name: [_ranked(search, one, need) for need in needs] for one in rankers}
    ranked[_OURS] = [_found(search, need) for need in needs]
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
    return beside(Table("search", "How well nodes are found", columns, rows, notes), ("method", "measure"))


def _found(search: Search, need: Need) -> list[Ranked]:
    hits = search.find(need.query, limit=max(_DEPTHS)).hits
    return [Ranked(hit.package.repository, hit.package.name, hit.name) for hit in hits]


def _ranked(search: Search, ranker: Ranker, need: Need) -> list[Ranked]:
    """Return the best nodes by scores, of copies and variants the best; those of one score in the index's order."""
    index = search.index
    scores = np.asarray(ranker.scores(need))
    chosen: dict[int, int] = {}
    for place in np.lexsort((index.order, -scores)).tolist():
        if scores[place] <= 0 or len(chosen) == max(_DEPTHS):
            break
        chosen.setdefault(int(index.group[place]), place)
    found = (
        Hit(0, 0.0, node, index.packages[node.package], (), ())
        for node in map(index.nodes.__getitem__, chosen.values())
    )
    return [Ranked(hit.package.repository, hit.package.name, hit.name) for hit in found]


def _rows(depth: int, values: dict[str, list[float]]) -> list[tuple[Cell, ...]]:
    ours = values[_OURS]
    rows: list[tuple[Cell, ...]] = []
    for name, theirs in values.items():
        score = Score(_mean(theirs), bootstrap(theirs))
        above: tuple[Cell, Cell] = (None, None) if name == _OURS else _compared(ours, theirs)
        rows.append((name, f"NDCG@{depth}", score, *above))
    return rows


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _compared(ours: Sequence[float], theirs: Sequence[float]) -> tuple[Cell, Cell]:
    """Return the difference of the means and the relative one; None for that to a mean of zero."""
    differences = [one - other for one, other in zip(ours, theirs, strict=True)]
    difference = Score(_mean(differences), bootstrap(differences), signed=True)
    if not _mean(theirs):
        return difference, None
    chance = random.Random(0)  # noqa: S311 - no secret
    pairs = list(zip(differences, theirs, strict=True))
    drawn = (chance.choices(pairs, k=len(pairs)) for _ in range(_ROUNDS))
    sums = [(sum(one for one, _ in each), sum(other for _, other in each)) for each in drawn]
    ratios = bounds(one / other for one, other in sums if other)
    return difference, Score(_mean(differences) / _mean(theirs), ratios, signed=True)
