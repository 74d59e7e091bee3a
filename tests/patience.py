"""Time limits of tests: a promise about time holds on an idle machine, and test machines seldom are idle."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["examples", "patient", "until"]

_FACTOR = 4.0


def patient(seconds: float) -> float:
    """Return a time limit for work of at most `seconds` on an idle machine; benchmarks measure the real duration."""
    return seconds * max(_FACTOR, 2 * os.getloadavg()[0] / (os.cpu_count() or 1))


def until(holds: Callable[[], bool], seconds: float = 20) -> None:
    """Wait until a condition holds, with time for a busy machine."""
    end = time.monotonic() + patient(seconds)
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def examples(few: int, many: int) -> int:
    """Return the number of random examples of an expensive test: `few`, or `many` if `KG_TEST_DEEP` is set."""
    return many if os.environ.get("KG_TEST_DEEP") else few
