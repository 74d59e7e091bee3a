"""Slow first-time computations, done ahead: the view `prepare`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.views.complete import cache_of
from kg.views.find import search_over
from kg.views.lists import totals

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def prepare(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, int]:
    """Build the index of the search, the statistics of completion and all lists, which the store then keeps.

    Returns how many nodes (`nodes`) the index has.
    """
    search = search_over(snapshot, settings)
    cache_of(snapshot, settings).statistics(fresh=True)
    totals(snapshot, settings)
    return {"nodes": search.index.size}
