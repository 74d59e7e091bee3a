"""Which bindings of a name hold at a place: those before it, on branches that agree with what was chosen so far."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.extract.python.entities import Choice, Frame
    from kg.extract.python.unit import Arms, Binding, Unit

__all__ = ["END", "agreeing", "reaching", "with_arms"]

END: Final = 1 << 60
"""A place behind everything: what holds when a function that was defined earlier runs."""


def with_arms(choice: Choice, frame: Frame, arms: Arms) -> Choice | None:
    """Return the choice with the branches `arms` taken in `frame`; None when it took others."""
    merged = choice
    for start, number in arms:
        key = (frame.id, start)
        taken = merged.get(key)
        if taken is None:
            merged = {**merged, key: number}
        elif taken != number:
            return None
    return merged


def agreeing(one: Choice, other: Choice) -> Choice | None:
    """Return both choices together; None when they contradict each other."""
    if any(one.get(key, number) != number for key, number in other.items()):
        return None
    return {**one, **other} if other else one


def reaching(
    bindings: Sequence[Binding], position: int, frame: Frame, choice: Choice
) -> tuple[list[tuple[Binding, Choice]], bool]:
    """Return the bindings that can hold at `position`, last first, and whether one of them must.

    A binding on a branch holds only with that branch taken; one that is on every path ends the search.
    """
    found: list[tuple[Binding, Choice]] = []
    covered: dict[int, set[int]] = {}
    for binding in reversed(bindings):
        if binding.start > position or not _visible(binding, position):
            continue
        merged = with_arms(choice, frame, binding.arms)
        if merged is None:
            continue
        found.append((binding, merged))
        if len(merged) == len(choice) or _covers(binding, covered, binding.scope.unit):
            return found, True
    return found, False


def _visible(binding: Binding, position: int) -> bool:
    return binding.within is None or binding.within[0] <= position < binding.within[1]


def _covers(binding: Binding, covered: dict[int, set[int]], unit: Unit) -> bool:
    """Tell whether, with this binding, every branch of an `if` with `else` binds the name."""
    if len(binding.arms) != 1:
        return False
    start, number = binding.arms[0]
    seen = covered.setdefault(start, set())
    seen.add(number)
    count, complete = unit.arm_counts.get(start, (0, False))
    return complete and len(seen) == count
