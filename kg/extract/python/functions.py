"""Functions of Python that compute something of known values: numbers, orders, sums, and what holds for all items."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final

from kg.symbolic.operators import compute, plain, truth
from kg.symbolic.values import Number, Sequence, Text, Truth, Unknown, Value, number

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = ["FUNCTIONS"]

_COMPUTED: Final = Unknown("it is computed when the program runs")
_LONGEST_NUMBER: Final = 40
_MOST_ITEMS: Final = 5_000


def _whole(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`int(x)`."""
    del items
    return _converted(values, lambda value: number(int(value)))


def _floating(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`float(x)`."""
    del items
    return _converted(values, lambda value: Number(float(value), repr(float(value))))


def _converted(values: list[Value], convert: Callable[[str | float], Value]) -> Value:
    of = values[0] if values else number(0)
    known = plain(of)
    if known is None or getattr(of, "parameter", None) is not None or len(str(known)) > _LONGEST_NUMBER:
        return of
    try:
        return convert(known)
    except (ValueError, OverflowError):
        return Unknown(f"`{known}` is no number")


def _truth(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`bool(x)`."""
    del items
    of = values[0] if values else Truth(False)
    held = truth(of)
    return held if isinstance(held, Truth) else of


def _absolute(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`abs(x)`."""
    del items
    of = values[0] if values else _COMPUTED
    if not isinstance(of, Number):
        return of
    return Number(abs(of.value), of.written.removeprefix("-"), of.parameter)


def _plain(found: list[Value] | None) -> list[str] | list[float] | None:
    """Return texts, or numbers, that are all known; None for others."""
    texts = [one.known for one in found or () if isinstance(one, Text) and one.known is not None]
    if texts and len(texts) == len(found or ()):
        return texts
    numbers = [one.value for one in found or () if isinstance(one, Number)]
    return numbers if len(numbers) == len(found or ()) else None


def _sorted(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`sorted(x)`; items that are not known stay where they are."""
    found = items(values[0]) if values else None
    if found is None:
        return values[0] if values else _COMPUTED
    order = _plain(found)
    if order is None:
        return Sequence(tuple(found))
    return Sequence(tuple(one for _, _, one in sorted(zip(order, itertools.count(), found, strict=False))))


def _reversed(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    found = items(values[0]) if values else None
    return Sequence(tuple(reversed(found))) if found is not None else values[0] if values else _COMPUTED


def _sum(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`sum(x, start)`."""
    found = items(values[0]) if values else None
    if found is None:
        return _COMPUTED
    start = values[1] if len(values) > 1 else number(0)
    return compute("+", (start, *found)) if found else start


def _extreme(choose: Callable[[Iterable[int], Callable[[int], float]], int]) -> Callable[..., Value]:
    def apply(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
        found = items(values[0]) if len(values) == 1 else values
        numbers = [one.value for one in found or () if isinstance(one, Number)]
        if not found or len(numbers) < len(found):
            return _COMPUTED
        return found[choose(range(len(numbers)), numbers.__getitem__)]

    return apply


def _all_of(wanted: bool) -> Callable[..., Value]:  # noqa: FBT001 - `all` or `any`
    def apply(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
        held = {truth(one) for one in (items(values[0]) if values else None) or [_COMPUTED]}
        if Truth(not wanted) in held:
            return Truth(not wanted)
        return Truth(wanted) if held <= {Truth(wanted)} else Unknown("not all are known")

    return apply


def _chain(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`itertools.chain(*x)`."""
    columns = [items(value) for value in values]
    return Sequence(tuple(one for column in columns for one in column or ()), open=None in columns)


def _product(values: list[Value], items: Callable[[Value], list[Value] | None]) -> Value:
    """`itertools.product(*x)`."""
    columns = [items(value) for value in values]
    known = [column for column in columns if column is not None]
    if len(known) < len(columns) or math.prod(map(len, known)) > _MOST_ITEMS:
        return _COMPUTED
    return Sequence(tuple(Sequence(row) for row in itertools.product(*known)))


FUNCTIONS: Final[dict[str, Callable[[list[Value], Callable[[Value], list[Value] | None]], Value]]] = {
    "builtins.int": _whole,
    "builtins.float": _floating,
    "builtins.bool": _truth,
    "builtins.abs": _absolute,
    "builtins.sorted": _sorted,
    "builtins.reversed": _reversed,
    "builtins.sum": _sum,
    "builtins.min": _extreme(lambda indexes, value: min(indexes, key=value)),
    "builtins.max": _extreme(lambda indexes, value: max(indexes, key=value)),
    "builtins.all": _all_of(True),
    "builtins.any": _all_of(False),
    "itertools.chain": _chain,
    "itertools.product": _product,
}
"""Functions by name, with their arguments and what gives the items of a value, if all are known."""
