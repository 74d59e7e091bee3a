"""The numbers that a loop counts, where they are known before it runs."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Final

from kg.robot.programs.kinds import constant

if TYPE_CHECKING:
    from kg.robot.programs.tree import For

__all__ = ["MOST", "counted"]

MOST: Final = 1000
"""How many numbers a tree may list."""
_SLACK: Final = 1e-9
_DIGITS: Final = 12
"""Digits behind the point that a tree lists: 0.1 + 0.2 is 0.3 there."""


def counted(loop: For) -> list[float] | None:
    """Return the numbers that a bare loop counts, None where they depend on the run, are endless or too many."""
    start, end = constant(loop.start), constant(loop.end)
    step = constant(loop.step)
    if start is None or end is None or (loop.step is not None and step is None):
        return None
    width = 1.0 if step is None else abs(step.value)
    steps = abs(end.value - start.value) / width if width else float("inf")
    if not isfinite(steps) or steps >= MOST:
        return None
    way = width if end.value >= start.value else -width
    return [round(float(start.value + number * way), _DIGITS) for number in range(int(steps + _SLACK) + 1)]
