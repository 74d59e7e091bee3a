"""Lexicon of the search: compounds, families, synonyms, words for message types, and everyday wordings."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from kg import resources

FILES: Final = ("search.toml", "everyday.toml")
"""The files of the lexicon in the folder `ontology`."""


@dataclass(frozen=True, slots=True)
class Lexicon:
    """The tables of `ontology/search.toml` and `ontology/everyday.toml`.

    `stop_words` are insignificant; `compounds` maps closed compounds to their words, `families` words to the one that
    represents them; `synonyms` contains groups of phrases, `everyday` the terms that each everyday wording stands for,
    with their places in its line, `types` the last parts of message types by phrase, `directions` the phrases before
    them, `asides` the phrases that begin and end asides, and `weights` those of the ranking (`fields`, `rank`,
    `wishes`, `down`).
    """

    stop_words: frozenset[str]
    compounds: Mapping[str, tuple[str, ...]]
    families: Mapping[str, str]
    synonyms: tuple[tuple[str, ...], ...]
    everyday: Mapping[str, Mapping[str, int]]
    types: Mapping[str, tuple[str, ...]]
    directions: Mapping[str, tuple[str, ...]]
    asides: Mapping[str, tuple[str, ...]]
    weights: Mapping[str, Mapping[str, float]]


@lru_cache(maxsize=1)
def lexicon() -> Lexicon:
    """Return the lexicon shipped with `kg`."""
    content, wordings = (resources.table_of("ontology", file) for file in FILES)
    return Lexicon(
        frozenset(content["stop_words"].split()),
        {word: tuple(parts.split()) for word, parts in content["compounds"].items()},
        {other: word for word, others in content["families"].items() for other in others},
        tuple(tuple(group) for group in content["synonyms"].values()),
        _by_wording(wordings.values()),
        {phrase: tuple(types) for phrase, types in content["types"].items()},
        {direction: tuple(phrases) for direction, phrases in content["directions"].items()},
        {turn: tuple(phrases) for turn, phrases in content["asides"].items()},
        {kind: {name: float(one) for name, one in table.items()} for kind, table in content["weights"].items()},
    )


def _by_wording(tables: Iterable[str]) -> dict[str, dict[str, int]]:
    """Return the terms of each wording, with their places; an entry of a table is `term, term: wording, wording`."""
    found: defaultdict[str, dict[str, int]] = defaultdict(dict)
    for line in filter(None, "\n".join(tables).replace("\n    ", " ").splitlines()):
        terms, _, wordings = line.partition(":")
        for wording in wordings.split(","):
            for place, term in enumerate(terms.split(",")):
                own = found[wording.strip()]
                own[term.strip()] = min(place, own.get(term.strip(), place))
    return dict(found)
