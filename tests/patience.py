"""How long tests wait: promises about time are bounds on a machine that is idle, which those of tests seldom are."""

from __future__ import annotations

import os

__all__ = ["examples", "patient"]

_FACTOR = 4.0


def patient(seconds: float) -> float:
    """Return a bound for what takes at most `seconds` on an idle machine; benchmarks measure how long it does take."""
    return seconds * max(_FACTOR, 2 * os.getloadavg()[0] / (os.cpu_count() or 1))


def examples(few: int, many: int) -> int:
    """Return how many random examples an expensive test runs: `few`, or `many` if `KG_TEST_DEEP` is set."""
    return many if os.environ.get("KG_TEST_DEEP") else few
