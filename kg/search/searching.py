"""A complete search: the index of the current store, the need, the hits with their reasons."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kg.lazily import lazily
from kg.search import cache
from kg.search.filters import wishes
from kg.search.names import Names
from kg.search.needs import Need, parse
from kg.search.ranking import fits, scores
from kg.search.reasons import Reason, reasons

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from kg.search.documents import Document, PackageDocument
    from kg.search.index import Index
    from kg.store.embedded import EmbeddedStore
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from kg.search.index import build
    from kg.search.reading import read

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
        """Return the best hits for a need in words, restricted by filters (`kg.search.filters`).

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
