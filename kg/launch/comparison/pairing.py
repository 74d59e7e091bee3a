"""The pairing of things with the same name at both sides, or names that differ in the labels of their holes."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, TypeVar

from kg.holes import anonymous

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping

_Thing = TypeVar("_Thing")


def paired(
    before: Iterable[_Thing], after: Iterable[_Thing], key: Callable[[_Thing], Hashable]
) -> Iterator[tuple[_Thing | None, _Thing | None]]:
    """Yield pairs with the same key at both sides, in order; None for a side without a partner."""
    one, other = _numbered(before, key), _numbered(after, key)
    for name in sorted({*one, *other}, key=str):
        yield one.get(name), other.get(name)


def _numbered(things: Iterable[_Thing], key: Callable[[_Thing], Hashable]) -> Mapping[tuple[Hashable, int], _Thing]:
    seen: Counter[Hashable] = Counter()
    found = {}
    for thing in things:
        name = key(thing)
        seen[name] += 1
        found[name, seen[name]] = thing
    return found


def relabelled(
    one: Iterable[_Thing], other: Iterable[_Thing], key: Callable[[_Thing], tuple[str, ...]]
) -> Iterator[tuple[_Thing, _Thing]]:
    """Yield the pairs whose names are equal apart from the labels of unknown parts, which may change with the code."""
    for before, after in paired(one, other, lambda thing: tuple(map(anonymous, key(thing)))):
        if before is not None and after is not None:
            yield before, after
