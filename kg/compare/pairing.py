"""The pairing of what has the same name at both sides."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping

__all__ = ["paired"]

_Thing = TypeVar("_Thing")


def paired(
    before: Iterable[_Thing], after: Iterable[_Thing], key: Callable[[_Thing], Hashable]
) -> Iterator[tuple[_Thing | None, _Thing | None]]:
    """Yield what has the same key at both sides, and None for the side that has it not; the n-th with the n-th."""
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
