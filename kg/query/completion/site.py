"""A position in a query, with its context."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.query.completion.outline import Outline, outline
from kg.syntax.lexer import Kind, Token, tokens
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.query.completion.statistics import SnapshotCache, Statistics
    from kg.query.stored import StoredQuery


class Form(Enum):
    """The kind of the typed word, from its beginning."""

    NOTHING = auto()
    WORD = auto()
    """A keyword, or the beginning of a prefixed name."""
    NAME = auto()
    """A prefixed name."""
    VARIABLE = auto()
    STRING = auto()
    IRI = auto()
    COMMENT = auto()


class Typed(NamedTuple):
    """The typed beginning `text` of a token, from `start` to the position; `end` is the end of the token.

    `before` contains the tokens before it, `after` those after it. `quote` is the quotation mark of a string.
    """

    form: Form
    text: str
    start: int
    end: int
    before: list[Token]
    after: list[Token]
    quote: str = ""


_FORMS: Final = {Kind.WORD: Form.WORD, Kind.NAME: Form.NAME, Kind.VARIABLE: Form.VARIABLE}
_ALONE: Final = re.compile(r"\s*([A-Za-z][\w./-]*)")
"""Possible name of a stored query, at the beginning of the text."""
_OPEN_IRI: Final = re.compile(r"<[^\x00-\x20<>\"{}|^`\\]*\Z")
_REST: Final = {
    Form.WORD: re.compile(r"[\w-]*:?[\w-]*"),
    Form.NAME: re.compile(r"[\w-]*"),
    Form.VARIABLE: re.compile(r"\w*"),
    Form.IRI: re.compile(r"[^\x00-\x20<>\"{}|^`\\]*>?"),
}
_ANY: Final = re.compile("")
_OPERANDS: Final = frozenset({Kind.VARIABLE, Kind.NUMBER, Kind.STRING, Kind.IRI})


def typed(text: str, position: int) -> Typed:
    """Return the word being typed at `position` of `text`, an offset in code points that is clamped to the text."""
    position = max(0, min(position, len(text)))
    before = list(tokens(text[:position]))
    special = _string(text, position, before) or _comment(text, position, before) or _iri(text, position, before)
    if special:
        return special
    alone = _ALONE.fullmatch(text, 0, position)
    if alone:
        return _typed_at(Form.WORD, text, alone.start(1), position, [])
    form, start = Form.NOTHING, position
    if before and before[-1].end == position:
        last = before[-1]
        form = _FORMS.get(last.kind, Form.NOTHING)
        if last.kind is Kind.SIGN and last.text in {"?", "$"} and not _is_path(before):
            form = Form.VARIABLE
        if form is not Form.NOTHING:
            start = last.start
            before = before[:-1]
    return _typed_at(form, text, start, position, before)


def _typed_at(form: Form, text: str, start: int, position: int, before: list[Token]) -> Typed:
    match = _REST.get(form, _ANY).match(text, position)
    end = match.end() if match else position
    return Typed(form, text[start:position], start, end, before, _tokens_after(text, end))


def _tokens_after(text: str, end: int) -> list[Token]:
    return [token._replace(start=token.start + end, end=token.end + end) for token in tokens(text[end:])]


def _is_path(before: list[Token]) -> bool:
    """Return whether the trailing question mark makes a step of a path optional."""
    return len(before) > 1 and before[-2].end == before[-1].start and before[-2].kind in {Kind.NAME, Kind.IRI}


def _string(text: str, position: int, before: list[Token]) -> Typed | None:
    """Return the open string; the lexer returns an unclosed quotation mark as a sign."""
    for index, token in enumerate(before):
        if token.kind is Kind.SIGN and token.text in {'"', "'"}:
            line = text.find("\n", token.start, position)
            if line >= 0:
                return Typed(Form.COMMENT, "", position, position, before[:index], [])
            end = position + _closing(text, position, token.text)
            before_string = before[:index]
            return Typed(
                Form.STRING,
                text[token.end : position],
                token.start,
                end,
                before_string,
                _tokens_after(text, end),
                token.text,
            )
    return None


def _closing(text: str, position: int, quote: str) -> int:
    """Return the number of remaining characters of the string, if only name characters precede its closing mark."""
    match = re.compile(rf"[^\s{quote};,.(){{}}\[\]]*{quote}").match(text, position)
    return match.end() - position if match else 0


def _comment(text: str, position: int, before: list[Token]) -> Typed | None:
    begin = text.find("#", before[-1].end if before else 0, position)
    if begin < 0 or any(end in text[text.rfind("#", begin, position) : position] for end in "\r\n"):
        return None
    return Typed(Form.COMMENT, "", position, position, before, [])


def _iri(text: str, position: int, before: list[Token]) -> Typed | None:
    match = _OPEN_IRI.search(text, max(text.rfind("<", 0, position), 0), position)
    if match is None:
        return None
    before_iri = [token for token in before if token.end <= match.start()]
    if (
        before_iri
        and (before_iri[-1].kind in _OPERANDS or before_iri[-1].text == ")")
        and not _follows_term(text, match.start())
    ):
        return None
    return _typed_at(Form.IRI, text, match.start(), position, before_iri)


def _follows_term(text: str, start: int) -> bool:
    """Return whether a `<` begins an IRI. After an operator there is whitespace."""
    return text[start + 1 : start + 2] not in {"", "=", " "}


@dataclass(frozen=True, slots=True)
class Candidate:
    """A possible completion.

    `label` is shown, `insert` replaces the typed word, and `holes` are offsets in it to fill. `key` is matched with the
    typed text. Smaller `rank` comes first. `prefix` is the prefix of `insert`, if it is a prefixed name.
    """

    label: str
    insert: str
    kind: str
    key: str
    detail: str = ""
    count: int | None = None
    documentation: str = ""
    rank: int = 0
    holes: tuple[int, ...] = ()
    prefix: str = ""


@dataclass(frozen=True, slots=True)
class Site:
    """A position in a query. `before` is the outline before it, `whole` that of the query without the typed word."""

    text: str
    typed: Typed
    before: Outline
    whole: Outline
    cache: SnapshotCache
    statistics: Statistics
    stored: Callable[[], Sequence[StoredQuery]]

    @property
    def prefixes(self) -> dict[str, str]:
        """Prefixes that the query declares, the standard ones, and those of the store."""
        return {**self.statistics.prefixes, **PREFIXES, **self.before.prefixes}

    def short(self, iri: str) -> str:
        """Return an IRI as written in the query; its own declarations take precedence."""
        return shorten(iri, {**self.before.prefixes, **PREFIXES, **self.prefixes})

    def comment(self, iri: str) -> str:
        """Return the documentation of a term in the store."""
        return self.statistics.comments.get(iri, "")


_STANDS_FOR: Final = {Form.NAME: Kind.NAME, Form.VARIABLE: Kind.VARIABLE, Form.STRING: Kind.STRING, Form.IRI: Kind.IRI}


def site_of(
    text: str, typed: Typed, cache: SnapshotCache, statistics: Statistics, stored: Callable[[], Sequence[StoredQuery]]
) -> Site:
    """Return the site of the typed word in `text`."""
    before = outline(typed.before)
    whole = outline(typed.before)
    if typed.form in _STANDS_FOR:
        # A token replaces the typed word; without it, the rest of the query would be parsed one slot too early.
        outline(
            [Token(_STANDS_FOR[typed.form], "?" if typed.form is Form.VARIABLE else "", typed.start, typed.end)], whole
        )
    return Site(text, typed, before, outline(typed.after, whole), cache, statistics, stored)
