"""Names of which one has more to it: `imu/data` and `imu/data_compass`, `found/objects` and `found/tracker/objects`.

By itself that says little, since many topics of a node are named so. Where one end of each is missing, or the types
agree and only one name has both ends, it is how a topic gets lost when a part of a system is renamed.
"""

from __future__ import annotations

from collections import defaultdict
from itertools import combinations
from typing import TYPE_CHECKING, Final

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
        for name in sorted({name for name in names if "{}" not in name}):
            words = words_of(name)
            self._whole[words].append(name)
            for part in _parts(words):
                self._parts[part].append(name)

    def find(self, name: str) -> list[str]:
        """Return the names that have more to them than `name`, or less, sorted."""
        if "{}" in name:
            return []
        words = words_of(name)
        found = set(self._parts.get(words, ()))
        for part in _parts(words):
            found.update(self._whole.get(part, ()))
        return sorted(found - {name})


def related(one: str, other: str) -> bool:
    """Tell whether one of two names has words in one of its segments, or a namespace, that the other lacks."""
    if "{}" in one or "{}" in other:
        return False
    words, others = words_of(one), words_of(other)
    return others in _parts(words) or words in _parts(others)


def _parts(words: Words) -> Iterator[Words]:
    """Yield what is left without one or two words of a segment, or without a segment that is not the last."""
    for at in range(len(words) - 1):
        yield words[:at] + words[at + 1 :]
    for at, segment in enumerate(words):
        if len(segment) > _MOST_WORDS:
            continue
        for extra in range(1, min(_MOST_EXTRA, len(segment) - 1) + 1):
            for gone in combinations(range(len(segment)), extra):
                if not any(any(map(str.isdigit, segment[index])) for index in gone):
                    rest = tuple(word for index, word in enumerate(segment) if index not in gone)
                    yield (*words[:at], rest, *words[at + 1 :])
