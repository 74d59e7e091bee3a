"""Figures that come from samples: their intervals, the size of the sample of each group, and the estimate for all."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from kg.evaluate.tables import Score

Z95: Final = 1.959963984540054
"""Quantile of the normal distribution for a two-sided 95 % interval."""


def wilson(right: int, number: int) -> tuple[float, float]:
    """Return the interval of the share `right` of `number` (Wilson 1927); (0, 1) for an empty sample.

    It holds for small numbers and for shares near 0 and 1, unlike the normal approximation.
    """
    if number == 0:
        return 0.0, 1.0
    share, spread = right / number, Z95 * Z95 / number
    middle = (share + spread / 2) / (1 + spread)
    half = Z95 * math.sqrt(share * (1 - share) / number + spread / (4 * number)) / (1 + spread)
    low = 0.0 if right == 0 else max(0.0, middle - half)
    return low, 1.0 if right == number else min(1.0, middle + half)


def bootstrap(values: Sequence[float], *, rounds: int = 2000, seed: int = 0) -> tuple[float, float]:
    """Return the 95 % percentile interval of the mean (Efron 1979), deterministic for the same values and seed."""
    if not values:
        return 0.0, 0.0
    chance = random.Random(seed)  # noqa: S311 - no secret
    return bounds(sum(chance.choices(values, k=len(values))) / len(values) for _ in range(rounds))


def bounds(drawn: Iterable[float]) -> tuple[float, float]:
    """Return the bounds of the middle 95 % of one or more values."""
    ordered = sorted(drawn)
    number = len(ordered)
    return ordered[int(0.025 * number)], ordered[min(number - 1, int(0.975 * number))]


def shares_of(sizes: Mapping[str, int], size: int) -> dict[str, int]:
    """Return the sample size of each group: equal, with the remainder of small groups given to others."""
    shares = dict.fromkeys(sizes, 0)
    left = min(size, sum(sizes.values()))
    while left:
        open_ = [name for name, number in sizes.items() if shares[name] < number]
        for name in open_[:left]:
            shares[name] += 1
        left -= len(open_[:left])
    return shares


def weighed(groups: Iterable[tuple[int, int, int]]) -> Score | None:
    """Return the share over all groups with its 95 % interval (Cochran 1977, section 5.6).

    A group has its size, the size of its sample, and the number that is right in it. None if a group has no sample.
    """
    sampled = [group for group in groups if group[0]]
    every = sum(size for size, _, _ in sampled)
    if not every or any(not looked for _, looked, _ in sampled):
        return None
    value = variance = 0.0
    for size, looked, right in sampled:
        weight, part = size / every, right / looked
        value += weight * part
        variance += weight**2 * part * (1 - part) / looked * (1 - looked / size if looked <= size else 0)
    half = Z95 * math.sqrt(variance)
    return Score(value, (max(0.0, value - half), min(1.0, value + half)))
