"""Names of which one has more to it: `imu/data` and `imu/data_compass`, `found/objects` and `found/tracker/objects`.

Names of the same words in another order are related too, if they end alike: `camera/left/image`, `left_camera/image`.
By itself that says little, since many topics of a node are named so. Where one end of each is missing, or the types
agree and only one name has both ends, it is how a topic gets lost when a part of a system is renamed.
"""

from __future__ import annotations

from collections import defaultdict
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING, Final

from kg.holes import is_partial
from kg.wiring.similar import Words, words_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["Related", "related"]

_MOST_WORDS: Final = 8
_MOST_EXTRA: Final = 2


class Related:
    """An index of names by what is left of them without a word or two, or without a namespace."""

    def __init__(self, names: Iterable[str]) -> None:
        self._whole: defaultdict[Words, list[str]] = defaultdict(list)
        self._parts: defaultdict[Words, list[str]] = defaultdict(list)
        self._ordered: defaultdict[tuple[str, ...], list[str]] = defaultdict(list)
        for name in sorted({name for name in names if not is_partial(name)}):
            words = words_of(name)
            self._whole[words].append(name)
            self._ordered[_ordered(words)].append(name)
            for part in _parts(words):
                self._parts[part].append(name)

    def find(self, name: str) -> list[str]:
        """Return the names that have more to them than `name`, or less, or the same in another order, sorted."""
        if is_partial(name):
            return []
        words = words_of(name)
        found = {*self._ordered.get(_ordered(words), ())} - {*self._whole.get(words, ())}
        found.update(self._parts.get(words, ()))
        for part in _parts(words):
            found.update(self._whole.get(part, ()))
        return sorted(found - {name})


def related(one: str, other: str) -> bool:
    """Tell whether one of two names has words or a namespace that the other lacks, or the same in another order."""
    if is_partial(one) or is_partial(other):
        return False
    words, others = words_of(one), words_of(other)
    if others in _parts(words) or words in _parts(others):
        return True
    return words != others and _ordered(words) == _ordered(others)


def _ordered(words: Words) -> tuple[str, ...]:
    """Return the words of a name in one order, behind those of its last segment, which stay where they are."""
    return *(words[-1] if words else ()), "/", *sorted(word for segment in words[:-1] for word in segment)


def _parts(words: Words) -> Iterator[Words]:
    """Yield what is left without one or two words of a segment, or without a segment that is not the last."""
    for at in range(len(words) - 1):
        yield words[:at] + words[at + 1 :]
    for at, segment in enumerate(words):
        for rest in _shorter(segment):
            yield (*words[:at], rest, *words[at + 1 :])


@lru_cache(maxsize=16_384)
def _shorter(segment: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """Return what is left of the words of a segment without one or two; words with digits stay."""
    if len(segment) > _MOST_WORDS:
        return ()
    return tuple(
        tuple(word for index, word in enumerate(segment) if index not in gone)
        for extra in range(1, min(_MOST_EXTRA, len(segment) - 1) + 1)
        for gone in combinations(range(len(segment)), extra)
        if not any(any(map(str.isdigit, segment[index])) for index in gone)
    )
