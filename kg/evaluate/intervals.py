"""Intervals for figures that come from samples."""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Z95: Final = 1.959963984540054
"""The quantile of the normal distribution that bounds 95 % on both sides."""


def wilson(right: int, number: int, z: float = Z95) -> tuple[float, float]:
    """Return the interval of the share `right` of `number` (Wilson 1927); (0, 1) when nothing was counted.

    It holds for small numbers and for shares near 0 and 1, where the simple normal interval does not.
    """
    if number == 0:
        return 0.0, 1.0
    share, spread = right / number, z * z / number
    middle = (share + spread / 2) / (1 + spread)
    half = z * math.sqrt(share * (1 - share) / number + spread / (4 * number)) / (1 + spread)
    low = 0.0 if right == 0 else max(0.0, middle - half)
    return low, 1.0 if right == number else min(1.0, middle + half)


def bootstrap(values: Sequence[float], *, rounds: int = 2000, seed: int = 0) -> tuple[float, float]:
    """Return the 95 % percentile interval of the mean (Efron 1979), the same for the same values and seed."""
    if not values:
        return 0.0, 0.0
    chance = random.Random(seed)  # noqa: S311 - no secret
    return bounds(sum(chance.choices(values, k=len(values))) / len(values) for _ in range(rounds))


def bounds(drawn: Iterable[float]) -> tuple[float, float]:
    """Return the values that bound the middle 95 % of what was drawn, at least one value."""
    ordered = sorted(drawn)
    number = len(ordered)
    return ordered[int(0.025 * number)], ordered[min(number - 1, int(0.975 * number))]
