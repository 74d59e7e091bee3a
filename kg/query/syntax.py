"""Syntax errors of the engine in queries and updates, with place, excerpt and suggestions."""

from __future__ import annotations

import itertools
import re
from difflib import get_close_matches
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import pyoxigraph

from kg.errors import Place, QueryError, RuleError
from kg.query.completion.vocabulary import AGGREGATES, FUNCTIONS, KEYWORDS
from kg.similar import did_you_mean, suggest
from kg.syntax.lexer import Kind, Token, tokens
from kg.syntax.names import PREFIXES, WELL_KNOWN, is_absolute
from kg.syntax.parser import parse_query
from kg.syntax.position import offset_of, place_at, place_of

if TYPE_CHECKING:
    from collections.abc import Callable

    Parse: TypeAlias = Callable[[str], object]

_POSITION = re.compile(r"error at (\d+):(\d+): expected (.*)", re.DOTALL)
_SENTENCE = re.compile(r"(?:^|one of |, )([A-Z][a-z]+ [A-Za-z][^\[\]\"']*?)(?=, |$)")
_BLANKS = 64
"""Longer than any keyword."""
_FORMS = ("SELECT", "CONSTRUCT", "ASK", "DESCRIBE")
_BEGINNINGS = "A query begins with SELECT, CONSTRUCT, ASK or DESCRIBE."
_WORDS = tuple(dict.fromkeys(word for name in (*KEYWORDS, *AGGREGATES, *FUNCTIONS) for word in name.split()))
_ALIKE = 0.75
_SHORTEST = 4
"""Most words look like misspellings of shorter ones."""
_TEMPLATES = frozenset({"INSERT", "DELETE", "INSERT DATA", "DELETE DATA", "DELETE WHERE"})
_BROKEN_IRI = re.compile(r"<\w+://[^<>\n]*>")
_NOT_IN_IRIS = re.compile(r"[\x00-\x20\"{}|\\^`]")
"""IRIREF in the grammar of SPARQL."""
_UPDATES = ("INSERT", "DELETE", "WITH", "CLEAR", "DROP", "CREATE", "ADD", "MOVE", "COPY", "LOAD")

_OPERATIONS = (
    "An update begins with INSERT, DELETE or WITH, or changes graphs with CLEAR, DROP, CREATE, ADD, MOVE or COPY."
)


def syntax_error(
    error: SyntaxError, text: str, path: str, parse_update: Parse | None = None, *, base: str | None = None
) -> QueryError:
    """Return KG501 for the engine's `error` about `text`, at the place of the first unexpected token.

    The engine reports where its parser gave up, which is often far behind the cause. So the cause is searched for: in a
    query by the parser of `kg`, in an update by its tokens. Both are believed only if they agree with the engine. Of
    the engine's message only the sentences are used, without its list of expected tokens.

    For an update, `parse_update` parses it with the engine and raises its errors. Relative IRIs of a query are resolved
    against `base`.
    """
    lexed = list(tokens(text))
    special = _open_quote(lexed, text, path) or _broken_iri(lexed, text, path) or _undeclared(lexed, text, path)
    special = special or _begins_otherwise(lexed, text, path, update=parse_update is not None)
    if special:
        return special
    match = _POSITION.match(error.msg)
    if match is None:
        return QueryError("KG501", error.msg, place=place_of(text, 1, 1, path))
    reported = offset_of(text, int(match[1]), int(match[2]))
    sentence = _SENTENCE.search(match[3])
    cause = _misplaced(lexed, reported, text, path) if parse_update else None
    if cause is None and not sentence:
        parse = parse_update or partial(pyoxigraph.Store().query, base_iri=base, prefixes=dict(PREFIXES))
        culprit = _first_misfit(lexed, text, reported, parse)
        cause = None if parse_update else _parsed(lexed, text, path, base, culprit.start if culprit else len(text))
        return cause or _unexpected(culprit, text, path, update=parse_update is not None)
    cause = cause or (None if parse_update else _parsed(lexed, text, path, base, None))
    if cause or sentence is None:
        return cause or QueryError("KG501", error.msg, place=place_at(text, reported, path))
    end = next((token.end for token in lexed if token.start <= reported < token.end), reported)
    return QueryError("KG501", sentence[1][0].lower() + sentence[1][1:], place=place_at(text, reported, path, end))


def _parsed(lexed: list[Token], text: str, path: str, base: str | None, culprit: int | None) -> QueryError | None:
    """Return the error of the parser of `kg` about a query, unless it contradicts the engine.

    `culprit` is the offset of the engine's first unexpected token; None if the engine parsed all tokens, and objects to
    their meaning. An unexpected token must be the same one. What a query means goes wrong before the engine notices.
    """
    try:
        parse_query(text, path, base)
    except RuleError as error:
        place = error.place
        if error.code != "KG201" or place is None or place.line is None or place.column is None:
            return None
        offset = offset_of(text, place.line, place.column)
        expected = error.message.startswith("expected")
        if (offset != culprit) if expected else (culprit is not None and offset > culprit):
            return None
        token = next((token for token in lexed if token.start == offset), None)
        hint = error.hint or (_suggestion(token) if token and expected else None)
        return QueryError(
            "KG501", error.message, place=place_at(text, offset, path, token.end if token else offset), hint=hint
        )
    return None


def _unexpected(culprit: Token | None, text: str, path: str, *, update: bool) -> QueryError:
    if culprit is None:
        return QueryError("KG501", f"the {'update' if update else 'query'} ends too early", place=_behind(text, path))
    place = place_at(text, culprit.start, path, culprit.end)
    if culprit.kind is Kind.IRI and not is_absolute(culprit.text[1:-1]):
        hint = "Declare BASE <...> or write it out."
        return QueryError("KG501", f"the IRI `{culprit.text}` is relative", place=place, hint=hint)
    return QueryError("KG501", f"`{culprit.text}` is not expected here", place=place, hint=_suggestion(culprit))


def _suggestion(token: Token) -> str | None:
    return suggest(similar_keywords(token.text)) if token.kind is Kind.WORD else None


def _misplaced(lexed: list[Token], reported: int, text: str, path: str) -> QueryError | None:
    """Return the error about a term that the braces before the offset `reported` must not contain.

    DATA must not contain variables, and no deletion blank nodes (SPARQL 1.1 Query, section 19.8, notes 7 to 9).
    """
    opened = _template_before(lexed, reported)
    if opened is None:
        return None
    kind, inside = opened
    for before, token in itertools.pairwise(inside):
        noun = None
        if token.kind is Kind.VARIABLE and kind.endswith("DATA"):
            noun = "variables"
        elif (token.text.startswith("_:") or token.text == "[") and kind.startswith("DELETE"):
            noun = "blank nodes"
        elif token.kind in {Kind.STRING, Kind.NUMBER} and before.text in {"{", "."}:
            noun = "literals as subjects"
        if noun:
            place = place_at(text, token.start, path, token.end)
            return QueryError("KG501", f"{noun} are not allowed in {kind}", place=place)
    return None


def _template_before(lexed: list[Token], reported: int) -> tuple[str, list[Token]] | None:
    """Return the last template or data that begins before an offset: its keywords, and its tokens from the brace on."""
    words = [token.text.upper() for token in lexed]
    for at in range(len(lexed) - 1, -1, -1):
        if lexed[at].start >= reported or words[at] not in {"INSERT", "DELETE"}:
            continue
        brace = at + 1 if words[at + 1 : at + 2] == ["{"] else at + 2
        kind = " ".join(words[at:brace])
        if words[brace : brace + 1] != ["{"] or kind not in _TEMPLATES:
            continue
        depth = 0
        for end in range(brace, len(lexed)):
            depth += (words[end] == "{") - (words[end] == "}")
            if depth == 0:
                return kind, lexed[brace:end]
        return kind, lexed[brace:]
    return None


def similar_keywords(word: str) -> list[str]:
    """Return the keywords and functions that a word may be a misspelling of; empty if it is one."""
    typed = word.upper()
    return [] if typed in _WORDS or len(typed) < _SHORTEST else get_close_matches(typed, _WORDS, n=2, cutoff=_ALIKE)


def _first_misfit(lexed: list[Token], text: str, reported: int, parse: Parse) -> Token | None:
    """Return the first unexpected token; None if the text only ends too early.

    The engine compares keywords by their length and reports the place where an unmatched keyword would have ended, up
    to a keyword after the unexpected token. So beginnings of the query are tested: one is valid if the engine, given it
    with whitespace longer than any keyword and an invalid character, reports that character.
    """
    misfit = None
    for token in reversed([token for token in lexed if token.start <= reported]):
        if _reaches_end(text[: token.end], parse):
            return misfit or next((later for later in lexed if later.start > token.start), None)
        misfit = token
    return misfit


def _reaches_end(beginning: str, parse: Parse) -> bool:
    """Return whether the engine can parse the whole `beginning` of a query or an update."""
    try:
        parse(beginning + " " * _BLANKS + "\0")
    except SyntaxError as error:
        match = _POSITION.match(error.msg)
        return match is None or offset_of(beginning, int(match[1]), int(match[2])) >= len(beginning) + _BLANKS
    return True


def _open_quote(lexed: list[Token], text: str, path: str) -> QueryError | None:
    for token in lexed:
        if token.kind is Kind.SIGN and token.text in {"'", '"'}:
            return QueryError("KG501", "this quote is never closed", place=place_at(text, token.start, path, token.end))
    return None


def _broken_iri(lexed: list[Token], text: str, path: str) -> QueryError | None:
    """Return the error about an IRI with a character that IRIs do not contain, such as a space."""
    for token in lexed:
        match = _BROKEN_IRI.match(text, token.start) if token.text == "<" else None
        if match and (sign := _NOT_IN_IRIS.search(match[0][1:-1])):
            place = place_at(text, token.start, path, match.end())
            name = f"`{sign[0]}`" if sign[0].isprintable() and sign[0] != " " else f"U+{ord(sign[0]):04X}"
            hint = f"Write %{ord(sign[0]):02X} for it."
            return QueryError("KG501", f"an IRI must not contain {name}", place=place, hint=hint)
    return None


def _undeclared(lexed: list[Token], text: str, path: str) -> QueryError | None:
    """Return the error about the first undeclared prefix."""
    declared = set(PREFIXES)
    for before, token in itertools.pairwise(lexed):
        if before.text.lower() == "prefix" and token.kind is Kind.NAME:
            declared.add(token.text.partition(":")[0])
    for token in lexed:
        prefix = token.text.partition(":")[0]
        if token.kind is Kind.NAME and prefix != "_" and prefix not in declared:
            close = [] if prefix in WELL_KNOWN else [f"{name}:" for name in declared if name]
            hint = did_you_mean(f"{prefix}:", close)
            hint = hint or f"Declare it: PREFIX {prefix}: <{WELL_KNOWN.get(prefix, '...')}>"
            place = place_at(text, token.start, path, token.end)
            return QueryError("KG501", f"the prefix `{prefix}:` is not declared", place=place, hint=hint)
    return None


def _begins_otherwise(lexed: list[Token], text: str, path: str, *, update: bool) -> QueryError | None:
    """Return the error about a text that does not begin with a query form, or for an `update` with an operation."""
    token = _after_prologue(lexed)
    if token is None:
        empty = QueryError("KG501", "the query is empty", place=_behind(text, path), hint=_BEGINNINGS)
        return None if update else empty
    wanted, others, hint = (_UPDATES, _FORMS, _OPERATIONS) if update else (_FORMS, _UPDATES, _BEGINNINGS)
    what, other = ("an update", "a query") if update else ("a query", "an update")
    if token.text.upper() in wanted:
        return None
    place = place_at(text, token.start, path, token.end)
    if token.text.upper() in others:
        return QueryError("KG501", f"this is {other}, not {what}", place=place, hint=hint)
    near = did_you_mean(token.text, (*wanted, "PREFIX", "BASE")) if token.kind is Kind.WORD else None
    return QueryError("KG501", f"{what} does not begin with `{token.text}`", place=place, hint=near or hint)


def _after_prologue(lexed: list[Token]) -> Token | None:
    position = 0
    while position < len(lexed) and lexed[position].text.lower() in {"prefix", "base"}:
        position += 3 if lexed[position].text.lower() == "prefix" else 2
    return lexed[position] if position < len(lexed) else None


def _behind(text: str, path: str) -> Place:
    return place_at(text, len(text), path, len(text))
