"""Split text and identifiers into comparable terms: lower case, without stop words, stemmed.

Stems are those of the Snowball algorithm for English (Porter 2001), which needs neither a model nor a tagger.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from snowballstemmer.english_stemmer import EnglishStemmer

from kg import resources

_WORD: Final = re.compile(
    r"\d[dD](?![a-zA-Z])"  # 2D, 3d
    r"|(?<![A-Za-z])[A-Z]{2}[a-z]{2,}"  # RViz, GMapping
    r"|[A-Z]{2,}s?(?![a-z])"  # URDF, TFs
    r"|[A-Z]+(?=[A-Z][a-z])"  # the XML of XMLFile
    r"|[A-Z]?[a-z]+"
    r"|[A-Z]+"
    r"|[^\W\d_]+"  # letters of other scripts
    r"|\d+"
)
_COMPOSITE: Final = re.compile(r"[A-Za-z]+[A-Z][A-Za-z0-9]*|\b[A-Za-z]{1,4}-[A-Za-z]{2,}")
_LONGEST_JOINED: Final = 14
_WITHOUT: Final = frozenset(("no", "without"))
_SHORT: Final = 2
_NAME: Final = 60
_STEMMER: Final = EnglishStemmer()
_BRITISH: Final = re.compile(r"(?<=..)([iy])s(?=(?:e|ed|er|ers|es|ing|ations?)$)")
_OUR: Final = re.compile(r"(?<=...)our(?=(?:s|ed|ing)?$)")


def words(text: str) -> Iterator[str]:
    """Yield the words of prose or of identifiers, in lower case: rgb, d, image, synchronize for `RGBDImage_sync`."""
    compounds = lexicon().compounds
    for match in _WORD.finditer(text):
        word = match.group().lower()
        yield from compounds.get(word, (word,))


@lru_cache(maxsize=1 << 16)
def stem(word: str) -> str:
    """Return the stem of a word in lower case; words of a family share it."""
    stemmed = _stemmed(word)
    return _families().get(stemmed, stemmed)


def _stemmed(word: str) -> str:
    """Return the stem of a word; British and American spellings share it.

    Words such as `noise` are changed too, which is harmless because stems are only compared.
    """
    if len(word) <= _SHORT:
        return word
    stem_of: str = _STEMMER.stemWord(_OUR.sub("or", _BRITISH.sub(r"\1z", word)))
    return stem_of


@lru_cache(maxsize=1)
def _families() -> dict[str, str]:
    return {_stemmed(other): _stemmed(word) for other, word in lexicon().families.items()}


def is_stop(word: str) -> bool:
    """Return whether a word is insignificant: a grammatical word, or one that applies to every node."""
    return word in lexicon().stop_words


def phrase(text: str) -> tuple[str, ...]:
    """Return the stems of all words of a text, including stop words."""
    return tuple(map(stem, words(text)))


def content_terms(text: str) -> tuple[str, ...]:
    """Return the stems of the significant words of a text."""
    return tuple(stem(word) for word in words(text) if not is_stop(word))


def name_terms(name: str) -> list[str]:
    """Return the terms of an identifier, except those that it negates: `MarkersNoKinect` has no kinect."""
    stems, skip = [], False
    for word in words(name):
        if skip:
            skip = False
        elif word in _WITHOUT:
            skip = True
        elif not is_stop(word):
            stems.append(stem(word))
    return stems


def terms(text: str) -> tuple[str, ...]:
    """Return the terms of a text in order, with repetitions."""
    return _short_terms(text) if len(text) <= _NAME else _terms(text)


def joined(text: str) -> tuple[str, ...]:
    """Return the stems of names that may be written as one word: influxdb of InfluxDB, wifi of Wi-Fi."""
    names = (
        match.group() for match in _COMPOSITE.finditer(text) if "-" in match.group() or not match.group().isupper()
    )
    plain = (name.replace("-", "").lower() for name in names)
    return tuple(stem(name) for name in plain if _SHORT < len(name) <= _LONGEST_JOINED)


def _terms(text: str) -> tuple[str, ...]:
    return (*content_terms(text), *joined(text))


# Names of topics, types and parameters recur, sentences do not.
_short_terms = lru_cache(maxsize=1 << 15)(_terms)


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
