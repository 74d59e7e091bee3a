"""Samples of several groups of different size: how many to take of each, and what they tell of all."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kg.evaluate.intervals import Z95
from kg.evaluate.tables import Score

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


def shares_of(sizes: Mapping[str, int], size: int) -> dict[str, int]:
    """Return how many each group gives: the same for all, what one cannot give is taken from the others."""
    found = dict.fromkeys(sizes, 0)
    left = min(size, sum(sizes.values()))
    while left:
        open_ = [name for name, number in sizes.items() if found[name] < number]
        for name in open_[:left]:
            found[name] += 1
        left -= len(open_[:left])
    return found


def weighed(groups: Iterable[tuple[int, int, int]]) -> Score | None:
    """Return the share of all groups together with its 95 % interval (Cochran 1977, section 5.6).

    A group has its size, how many were looked at, and how many of these were right. None when nothing of a group was
    looked at.
    """
    known = [group for group in groups if group[0]]
    every = sum(size for size, _, _ in known)
    if not every or any(not looked for _, looked, _ in known):
        return None
    value = variance = 0.0
    for size, looked, right in known:
        weight, part = size / every, right / looked
        value += weight * part
        variance += weight**2 * part * (1 - part) / looked * (1 - looked / size if looked <= size else 0)
    half = Z95 * math.sqrt(variance)
    return Score(value, (max(0.0, value - half), min(1.0, value + half)))
