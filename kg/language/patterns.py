"""Noun phrases that name hardware, by the patterns in `ontology/hardware-patterns.toml` (RNKG, section 3.2.4).

The patterns are compiled to a spaCy `Matcher`, whose matches are phrases.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final

from kg import resources
from kg.errors import Place, UsageError
from kg.facts.texts import Phrase
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from spacy.tokens import Doc, Token
    from spacy.vocab import Vocab

with lazily():
    from spacy.matcher import Matcher

FILE_NAME: Final = "hardware-patterns.toml"

_REFERENCE: Final = re.compile(r"([a-z]+)(?:([?*+])|\{(\d+),(\d+)\})?")
_LONGEST_PHRASE: Final = 8  # longer phrases are lists without commas, or not prose

_NOUNS: Final = frozenset({"NOUN", "PROPN"})

Tokens = list[dict[str, Any]]


@dataclass(frozen=True, slots=True)
class Pattern:
    """A pattern for the `Matcher`; `begin` and `end` are the numbers of context tokens before and after the phrase."""

    name: str
    example: str
    documentation: str
    before: Tokens
    phrase: Tokens
    after: Tokens


@cache
def read_patterns(path: Path | None = None) -> tuple[Pattern, ...]:
    """Return the patterns of a file, by default of the shipped one.

    Raises:
        UsageError: KG143 if the file cannot be read, or a pattern refers to an undefined name.
    """
    path = path or resources.folder("ontology") / FILE_NAME
    try:
        content = tomllib.loads(path.read_text("utf-8"))
        return tuple(_patterns(content))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as problem:
        reason = f"{problem.args[0]!r} is not defined" if isinstance(problem, KeyError) else str(problem)
        raise UsageError("KG143", f"the patterns of phrases cannot be read: {reason}", place=Place(str(path))) from None


def _patterns(content: Mapping[str, Any]) -> Iterator[Pattern]:
    words = {f"@{name}": members for name, members in content.get("words", {}).items()}
    tokens = content.get("tokens", {})
    for one in content["pattern"]:
        before, phrase, after = (
            [token for part in one.get(key, ()) for token in _tokens(part, tokens, words)]
            for key in ("before", "phrase", "after")
        )
        yield Pattern(one["name"], one["example"], one["documentation"], before, phrase, after)


def _tokens(part: str | dict[str, Any], tokens: Mapping[str, Any], words: Mapping[str, Any]) -> Tokens:
    """Return a part of a pattern with its references to `[tokens]` and `[words]` resolved.

    `{n,m}` is expanded to that many tokens, some of them optional, to match the token indices that spaCy reports.
    """
    if isinstance(part, dict):
        return [{key: _filled(value, words) for key, value in part.items()}]
    reference = _REFERENCE.fullmatch(part)
    if reference is None:
        message = f"{part!r} is not a name in [tokens]"
        raise ValueError(message)
    name, operator, least, most = reference.groups()
    token = {key: _filled(value, words) for key, value in tokens[name].items()}
    if least is None:
        return [{**token, "OP": operator} if operator else token]
    return [token] * int(least) + [{**token, "OP": "?"}] * (int(most) - int(least))


def _filled(value: Any, words: Mapping[str, Any]) -> Any:
    if isinstance(value, dict):
        return {key: _filled(inner, words) for key, inner in value.items()}
    return words[value] if isinstance(value, str) and value.startswith("@") else value


class PhraseFinder:
    """Patterns compiled for documents of one vocabulary."""

    def __init__(self, vocab: Vocab, patterns: Sequence[Pattern]) -> None:
        """Compile the patterns; `UsageError` KG143 if spaCy rejects one."""
        self._patterns = {pattern.name: pattern for pattern in patterns}
        self._always = Matcher(vocab)
        self._gated = Matcher(vocab)
        self._needed: set[int] = set()
        for pattern in patterns:
            words = _needed(pattern)
            self._needed.update(vocab.strings.add(word) for word in words)
            matcher = self._gated if words else self._always
            try:
                matcher.add(pattern.name, [[*pattern.before, *pattern.phrase, *pattern.after]])
            except ValueError as problem:
                reason = str(problem).strip().splitlines()[0]
                raise UsageError("KG143", f"spaCy refuses the pattern {pattern.name}: {reason}") from None

    def find(self, doc: Doc) -> tuple[Phrase, ...]:
        """Return the phrases of a document in order; of overlapping ones the longest, else the first.

        A dash with a space on one side separates two phrases.
        """
        matches: Any = self._always(doc, with_alignments=True)
        if not self._needed.isdisjoint(doc.to_array(["LEMMA", "LOWER"]).ravel().tolist()):
            matches += self._gated(doc, with_alignments=True)
        spans = {span for match in matches if (span := self._span(doc, match))}
        taken: set[int] = set()
        found: list[tuple[int, Phrase]] = []
        for begin, end, name in sorted(spans, key=lambda span: (span[0] - span[1], span[0], span[2])):
            if taken.isdisjoint(range(begin, end)):
                taken.update(range(begin, end))
                found.append((begin, Phrase(_text(doc[begin:end]), name)))
        return tuple(phrase for _, phrase in sorted(found, key=lambda one: one[0]))

    def _span(self, doc: Doc, match: tuple[int, int, int, list[int]]) -> tuple[int, int, str] | None:
        key, begin, _end, alignments = match
        pattern = self._patterns[doc.vocab.strings[key]]
        first = len(pattern.before)
        inside = range(first, first + len(pattern.phrase))
        own = [begin + place for place, part in enumerate(alignments) if part in inside]
        if not own or len(own) > _LONGEST_PHRASE:
            return None
        if any(_is_dash(doc, place) for place in own):
            return None
        return own[0], own[-1] + 1, pattern.name


def _needed(pattern: Pattern) -> list[str]:
    """Return words of which a text must contain one, as lemma or in lower case, for a pattern to match.

    The list is empty if any text may match. Most sentences name no hardware, and searching for words first is cheaper
    than matching.
    """
    for token in (*pattern.before, *pattern.phrase, *pattern.after):
        if "OP" not in token:
            for wanted in (token.get("LEMMA"), token.get("LOWER")):
                words = wanted.get("IN", []) if isinstance(wanted, dict) else [wanted] if wanted else []
                if words:
                    return list(words)
    return []


def _is_dash(doc: Doc, place: int) -> bool:
    """Return whether a hyphen separates the words around it."""
    token: Token = doc[place]
    return token.text == "-" and (place == 0 or bool(token.whitespace_) or bool(doc[place - 1].whitespace_))


def _text(tokens: Iterable[Token]) -> str:
    """Return the words of a phrase: nouns as lemmas, others as written ("charging station")."""
    return " ".join(
        (token.lemma_ if token.pos_ in _NOUNS else token.text).lower() for token in tokens if token.text != "-"
    )
