"""Lexicon of the search (`ontology/search.toml`): compounds, families, synonyms, words for message types."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from kg import resources

FILE: Final = "search.toml"
"""The file of the lexicon in the folder `ontology`."""


@dataclass(frozen=True, slots=True)
class Lexicon:
    """The tables of `ontology/search.toml`.

    `stop_words` are insignificant; `compounds` maps closed compounds to their words, `families` words to the one that
    represents them; `synonyms` contains groups of phrases, `everyday` what everyday phrases stand for, `types`
    the last parts of message types by phrase, `directions` the phrases before them, `asides` the phrases that begin and
    end asides, and `weights` those of the ranking (`fields`, `rank`, `wishes`, `down`).
    """

    stop_words: frozenset[str]
    compounds: Mapping[str, tuple[str, ...]]
    families: Mapping[str, str]
    synonyms: tuple[tuple[str, ...], ...]
    everyday: Mapping[str, tuple[str, ...]]
    types: Mapping[str, tuple[str, ...]]
    directions: Mapping[str, tuple[str, ...]]
    asides: Mapping[str, tuple[str, ...]]
    weights: Mapping[str, Mapping[str, float]]


@lru_cache(maxsize=1)
def lexicon() -> Lexicon:
    """Return the lexicon shipped with `kg`."""
    content = resources.table_of("ontology", FILE)
    return Lexicon(
        frozenset(content["stop_words"].split()),
        {word: tuple(parts.split()) for word, parts in content["compounds"].items()},
        {other: word for word, others in content["families"].items() for other in others},
        tuple(tuple(group) for group in content["synonyms"].values()),
        {words_typed: tuple(synonyms) for words_typed, synonyms in content["everyday"].items()},
        {phrase: tuple(types) for phrase, types in content["types"].items()},
        {direction: tuple(phrases) for direction, phrases in content["directions"].items()},
        {turn: tuple(phrases) for turn, phrases in content["asides"].items()},
        {kind: {name: float(one) for name, one in table.items()} for kind, table in content["weights"].items()},
    )
