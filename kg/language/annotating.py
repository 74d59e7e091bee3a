"""Annotate descriptions with their words and phrases (RNKG, sections 3.2.3 and 3.2.4).

A pure function of texts, pipeline and patterns: the same in any process and order. spaCy is loaded once per process, at
the first text with words.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Final

from kg.facts.texts import Description, DescriptionKind, Phrase
from kg.language.loading import pipeline
from kg.language.patterns import PhraseFinder, read_patterns

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from spacy.tokens import Doc


LONGEST_TEXT: Final = 20_000
"""Largest tagged part of a description in characters: ten pages; longer texts are data."""
_LONGEST_WORD: Final = 80  # longer words are data (keys, ASCII art) and are left out
_LONGEST_SENTENCE: Final = 2_000
"""Characters tagged at a time, so texts without full stops use no more memory than others."""
_LEAST_ENGLISH: Final = 0.6  # least share of letters of the English alphabet
_MOST_SIGNS: Final = 0.25  # a sentence with a larger share of signs is code or a drawing
STOP_WORDS: Final = frozenset({"be", "do", "get", "have", "let", "make", "use", "need", "want", "etc"})
"""Verbs that say nothing about the function of a node."""

_WORD_CLASSES: Final = frozenset({"ADJ", "NOUN", "PROPN", "VERB"})
_WORD: Final = re.compile(r"[a-z][a-z0-9+-]*[a-z0-9+]")
"""Lemmas to keep: no numbers, and no identifiers, which are names rather than functions."""
_LETTERS: Final = re.compile(r"[^\W\d_]")
_ENGLISH: Final = re.compile(r"[A-Za-z]")
_SIGNS: Final = re.compile(r"[^\w\s.,:'\"()/-]")
_UNPRINTABLE: Final = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u200b-\u200f\u2028-\u202e\ud800-\udfff\ufeff]")
_BOUNDARY: Final = re.compile(r"(?<=[^\W\d_][a-z0-9)\]'\"][.!?])\s+(?=[A-Z\"'(`])|\n{2,}|(?<=;)\s*\n")
_LAST_NUMBER: Final = re.compile(r"(?<=\w \d)\.$")
"""A full stop after a number at the end; at the beginning the two are one word, as in lists."""
_BATCH: Final = 128


@dataclass(frozen=True, slots=True)
class _Tagged:
    words: frozenset[str]
    phrases: tuple[Phrase, ...]


def annotate(
    descriptions: Iterable[Description], model: str | None = None, known: Mapping[str, Description] | None = None
) -> tuple[Description, ...]:
    """Return the descriptions with their `words` and `phrases`, in the same order.

    `model` is an installed spaCy pipeline or the folder of one, by default the shipped one. `known` maps texts to
    descriptions annotated with the same pipeline and patterns, which are reused. Descriptions of usage are not
    annotated: they are for search, and what they mention need not be what a package does.

    Raises:
        UsageError: KG141, KG142 if the pipeline is unusable, KG143 if the patterns are.
    """
    given = tuple(descriptions)
    earlier = {text: one for text, one in (known or {}).items() if one.kind is not DescriptionKind.USAGE}
    parts = {
        one.text: sentences(one.text)
        for one in given
        if one.kind is not DescriptionKind.USAGE and one.text not in earlier
    }
    # Comments and pages repeat sentences, and the tags of a sentence do not depend on its context.
    tagged = _tag(dict.fromkeys(sentence for part in parts.values() for sentence in part), model or "")
    found = []
    for one in given:
        if one.kind is DescriptionKind.USAGE:
            found.append(one)
        elif one.text in earlier:
            like = earlier[one.text]
            found.append(replace(one, words=like.words, phrases=like.phrases))
        else:
            own = [tagged[sentence] for sentence in parts[one.text]]
            words = sorted(frozenset[str]().union(*(each.words for each in own)))
            phrases = tuple(dict.fromkeys(phrase for each in own for phrase in each.phrases))
            found.append(replace(one, words=tuple(words), phrases=phrases))
    return tuple(found)


def prepare(model: str | None = None) -> None:
    """Load the dependencies of `annotate`, to share them with forked processes and to fail early.

    Raises:
        UsageError: as `annotate`.
    """
    _finder(model or "")


def sentences(text: str) -> list[str]:
    """Return the sentences of a text that are worth tagging: no other scripts, no code, no data."""
    clean = _UNPRINTABLE.sub(" ", text[:LONGEST_TEXT])
    found = []
    for part in _BOUNDARY.split(clean):
        kept = _LAST_NUMBER.sub(
            " .", " ".join(word for word in part.split() if len(word) <= _LONGEST_WORD)[:_LONGEST_SENTENCE]
        )
        if _is_language(kept):
            found.append(kept)
    return found


def _is_language(sentence: str) -> bool:
    letters = len(_LETTERS.findall(sentence))
    english = len(_ENGLISH.findall(sentence))
    return (
        english > 1
        and english >= _LEAST_ENGLISH * letters
        and len(_SIGNS.findall(sentence)) <= _MOST_SIGNS * len(sentence)
    )


def _tag(found: Iterable[str], model: str) -> dict[str, _Tagged]:
    texts = list(found)
    if not texts:
        return {}
    nlp, finder = pipeline(model), _finder(model)
    docs = nlp.pipe(texts, batch_size=_BATCH)
    return {text: _Tagged(_words(doc), finder.find(doc)) for text, doc in zip(texts, docs, strict=True)}


@cache
def _finder(model: str) -> PhraseFinder:
    return PhraseFinder(pipeline(model).vocab, read_patterns())


def _words(doc: Doc) -> frozenset[str]:
    lemmas = ((token.lemma_ or token.text).lower() for token in doc if token.pos_ in _WORD_CLASSES)
    return frozenset(lemma for lemma in lemmas if _WORD.fullmatch(lemma) and lemma not in STOP_WORDS)
