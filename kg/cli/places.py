"""Shortening of places in source code to fit a width."""

from __future__ import annotations

from collections.abc import Sequence

from kg.render.text import width


def shortened(places: Sequence[str]) -> tuple[list[str], ...]:
    """Return places in full, without their common folders, and as file names only."""
    folders = [place.split("/")[:-1] for place in places]
    shared = 0
    for level in zip(*folders, strict=False):
        if len(set(level)) > 1:
            break
        shared += len(level[0]) + 1
    without = [f"…/{place[shared:]}" if shared else place for place in places]
    return list(places), without, [place.rpartition("/")[2] for place in places]


def fitted(places: Sequence[str], room: int) -> list[str]:
    """Return the longest form of places that fits a number of columns, else the shortest."""
    *longer, shortest = shortened(places)
    return next((form for form in longer if max(map(width, form), default=0) <= room), shortest)
