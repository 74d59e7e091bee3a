"""Everyday wordings in a need, and the terms of robotics that they stand for (`ontology/everyday.toml`).

A wording matches words with the same stems in the same order. Articles and possessives do not count: `find the way`
is in `find its way`. `pick ... up` allows a few words at its gap: `pick the red box up`.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

from kg.search.lexicon import lexicon
from kg.search.words import content_terms, stem, words

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

_ARTICLES: Final = frozenset(("a", "an", "the", "my", "your", "his", "her", "its", "our", "their", "some", "any"))
_GAP: Final = "..."
_WIDEST: Final = 3  # so many words can stand at a gap
_START: Final = 2  # words with one stem have so many first letters in common


@dataclass(frozen=True, slots=True)
class Meaning:
    """A wording in a need: the indices of its words, and the terms that it stands for, with their relative weights."""

    places: tuple[int, ...]
    terms: Mapping[tuple[str, ...], float]


@dataclass(frozen=True, slots=True)
class _Pattern:
    """The stems of a wording, cut at its gaps, and its terms with their places in the line."""

    parts: tuple[tuple[str, ...], ...]
    terms: Mapping[str, int]


def meanings(typed: Sequence[str]) -> list[Meaning]:
    """Return the wordings in a need, given as its words; one that is part of a longer wording does not count."""
    places = [place for place, word in enumerate(typed) if word not in _ARTICLES]
    stems = [stem(typed[place]) for place in places]
    found: dict[tuple[int, ...], dict[str, int]] = {}
    for at, place in enumerate(places):
        for start in {typed[place][:_START], stems[at][:_START]}:
            for pattern in _patterns(start).get(stems[at], ()):
                if matched := _matched(pattern.parts, stems, at):
                    own = found.setdefault(tuple(places[one] for one in matched), {})
                    own.update((term, min(rank, own.get(term, rank))) for term, rank in pattern.terms.items())
    sets = [frozenset(one) for one in found]
    return [
        Meaning(one, _weighed(terms))
        for one, terms in sorted(found.items())
        if not any(other > frozenset(one) for other in sets)
    ]


def _weighed(terms: Mapping[str, int]) -> dict[tuple[str, ...], float]:
    """Return the stems of terms with their weights: each term of a line has less than the one before it."""
    later = lexicon().weights["rank"]["later"]
    return {content_terms(term): later**rank for term, rank in sorted(terms.items(), key=lambda one: one[1])}


def _matched(parts: Sequence[tuple[str, ...]], stems: Sequence[str], at: int) -> list[int]:
    """Return the indices of the words of a wording that begins at an index; none if it does not."""
    matched: list[int] = []
    for part in parts:
        last = at + _WIDEST if matched else at
        begin = next((one for one in range(at, last + 1) if tuple(stems[one : one + len(part)]) == part), None)
        if begin is None:
            return []
        at = begin + len(part)
        matched += range(begin, at)
    return matched


@cache
def _by_start() -> Mapping[str, list[str]]:
    """Return the wordings by their first letters: only those that a need may contain are stemmed."""
    starts: defaultdict[str, list[str]] = defaultdict(list)
    for wording in lexicon().everyday:
        starts[wording.partition(" ")[0][:_START]].append(wording)
    return starts


@cache
def _patterns(start: str) -> Mapping[str, list[_Pattern]]:
    """Return the patterns of the wordings with these first letters, by their first stem."""
    patterns: defaultdict[str, list[_Pattern]] = defaultdict(list)
    for wording in _by_start().get(start, ()):
        parts = tuple(tuple(_stems(part)) for part in wording.split(_GAP))
        patterns[parts[0][0]].append(_Pattern(parts, lexicon().everyday[wording]))
    return patterns


def _stems(text: str) -> Iterator[str]:
    return (stem(word) for word in words(text) if word not in _ARTICLES)
