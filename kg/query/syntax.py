"""Syntax errors of the engine in queries and updates, with place, excerpt and suggestions."""

from __future__ import annotations

import itertools
import re
from difflib import get_close_matches
from typing import TYPE_CHECKING

import pyoxigraph

from kg.errors import Place, QueryError
from kg.query.completion.outline import Slot, outline
from kg.query.completion.vocabulary import AGGREGATES, FUNCTIONS, KEYWORDS
from kg.similar import asked, did_you_mean
from kg.syntax.lexer import Kind, Token, tokens
from kg.syntax.names import PREFIXES, WELL_KNOWN
from kg.syntax.position import offset_of, place_at, place_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias

    Parse: TypeAlias = Callable[[str], object]

_POSITION = re.compile(r"error at (\d+):(\d+): expected (.*)", re.DOTALL)
_SENTENCE = re.compile(r"(?:^|one of |, )([A-Z][a-z]+ [A-Za-z][^\[\]\"']*?)(?=, |$)")
_BLANKS = 64
"""Longer than any keyword."""
_FORMS = ("SELECT", "CONSTRUCT", "ASK", "DESCRIBE")
_WORDS = tuple(dict.fromkeys(word for name in (*KEYWORDS, *AGGREGATES, *FUNCTIONS) for word in name.split()))
_ALIKE = 0.75
_SHORTEST = 4
"""Most words look like misspellings of shorter ones."""
_UPDATES = ("INSERT", "DELETE", "WITH", "CLEAR", "DROP", "CREATE", "ADD", "MOVE", "COPY", "LOAD")


def syntax_error(error: SyntaxError, text: str, path: str, parse_update: Parse | None = None) -> QueryError:
    """Return KG501 for the engine's `error` about `text`, at the place of the first unexpected token.

    Of the engine's message only the sentences are used, without its list of expected tokens. Two frequent mistakes have
    messages of their own: undeclared prefixes, and updates in place of queries. For an update, `parse_update` parses it
    with the engine and raises its errors.
    """
    found = list(tokens(text))
    special = _open_quote(found, text, path) or _undeclared(found, text, path)
    special = special or (_no_update if parse_update else _no_query)(found, text, path)
    if special:
        return special
    match = _POSITION.match(error.msg)
    if match is None:
        return QueryError("KG501", error.msg, place=place_of(text, 1, 1, path))
    line, column = int(match[1]), int(match[2])
    sentence = _SENTENCE.search(match[3])
    if sentence:
        message = sentence[1][0].lower() + sentence[1][1:]
        ungrouped = _ungrouped(found) if "unbound" in message else None
        if ungrouped:
            place = place_at(text, ungrouped.start, path, ungrouped.end)
            message = f"{ungrouped.text} is not a GROUP BY key and not aggregated"
            return QueryError("KG501", message, place=place)
        offset = offset_of(text, line, column)
        end = next((token.end for token in found if token.start <= offset < token.end), offset)
        return QueryError("KG501", message, place=place_at(text, offset, path, end))
    culprit = _first_misfit(found, text, offset_of(text, line, column), parse_update or _parse_query)
    if culprit is None:
        what = "update" if parse_update else "query"
        return QueryError("KG501", f"the {what} ends too early", place=_behind(text, path))
    place = place_at(text, culprit.start, path, culprit.end)
    hint = asked(keywords_meant(culprit.text)) if culprit.kind is Kind.WORD else None
    return QueryError("KG501", f"`{culprit.text}` is not expected here", place=place, hint=hint)


def keywords_meant(word: str) -> list[str]:
    """Return the keywords and functions that a word may be a misspelling of; empty if it is one."""
    typed = word.upper()
    return [] if typed in _WORDS or len(typed) < _SHORTEST else get_close_matches(typed, _WORDS, n=2, cutoff=_ALIKE)


def _ungrouped(found: list[Token]) -> Token | None:
    """Return the first variable of a SELECT that is missing from its GROUP BY."""
    uses = outline(found).uses
    grouped = {use.name for use in uses if use.slot is Slot.ORDER}
    projected = (use.token for use in uses if use.slot is Slot.PROJECTION and use.name not in grouped)
    return next(projected, None)


def _parse_query(text: str) -> object:
    return pyoxigraph.Store().query(text, prefixes=dict(PREFIXES))


def _first_misfit(found: list[Token], text: str, reported: int, parse: Parse) -> Token | None:
    """Return the first unexpected token; None if the text only ends too early.

    The engine compares keywords by their length and reports the place where an unmatched keyword would have ended, up
    to a keyword after the unexpected token. So beginnings of the query are tested: one is valid if the engine, given it
    with whitespace longer than any keyword and an invalid character, reports that character.
    """
    misfit = None
    for token in reversed([token for token in found if token.start <= reported]):
        if _reaches_end(text[: token.end], parse):
            return misfit or next((later for later in found if later.start > token.start), None)
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


def _open_quote(found: list[Token], text: str, path: str) -> QueryError | None:
    for token in found:
        if token.kind is Kind.SIGN and token.text in {"'", '"'}:
            return QueryError("KG501", "this quote is never closed", place=place_at(text, token.start, path, token.end))
    return None


def _undeclared(found: list[Token], text: str, path: str) -> QueryError | None:
    """Return the error about the first undeclared prefix."""
    declared = set(PREFIXES)
    for before, token in itertools.pairwise(found):
        if before.text.lower() == "prefix" and token.kind is Kind.NAME:
            declared.add(token.text.partition(":")[0])
    for token in found:
        prefix = token.text.partition(":")[0]
        if token.kind is Kind.NAME and prefix != "_" and prefix not in declared:
            close = [] if prefix in WELL_KNOWN else [f"{name}:" for name in declared]
            hint = did_you_mean(f"{prefix}:", close)
            hint = hint or f"Declare it: PREFIX {prefix}: <{WELL_KNOWN.get(prefix, '...')}>"
            place = place_at(text, token.start, path, token.end)
            return QueryError("KG501", f"the prefix `{prefix}:` is not declared", place=place, hint=hint)
    return None


def _no_query(found: list[Token], text: str, path: str) -> QueryError | None:
    """Return the error about a text that does not begin with a query form."""
    token = _after_prologue(found)
    if token is None:
        return QueryError("KG501", "the query is empty", place=_behind(text, path), hint=_forms())
    if token.text.upper() in _FORMS:
        return None
    place = place_at(text, token.start, path, token.end)
    if token.text.upper() in _UPDATES:
        return QueryError("KG501", "this is an update, not a query", place=place, hint=_forms())
    hint = did_you_mean(token.text, (*_FORMS, "PREFIX", "BASE")) if token.kind is Kind.WORD else None
    return QueryError("KG501", f"a query does not begin with `{token.text}`", place=place, hint=hint or _forms())


def _no_update(found: list[Token], text: str, path: str) -> QueryError | None:
    """Return the error about a text that does not begin with an update operation."""
    token = _after_prologue(found)
    if token is None or token.text.upper() in _UPDATES:
        return None
    place = place_at(text, token.start, path, token.end)
    if token.text.upper() in _FORMS:
        hint = (
            "An update begins with INSERT, DELETE or WITH, or changes graphs with CLEAR, DROP, CREATE, ADD, MOVE, COPY."
        )
        return QueryError("KG501", "this is a query, not an update", place=place, hint=hint)
    hint = (
        did_you_mean(token.text, (*_UPDATES, "PREFIX", "BASE")) or "An update begins with INSERT or DELETE, as a rule."
    )
    return QueryError("KG501", f"an update does not begin with `{token.text}`", place=place, hint=hint)


def _after_prologue(found: list[Token]) -> Token | None:
    position = 0
    while position < len(found) and found[position].text.lower() in {"prefix", "base"}:
        position += 3 if found[position].text.lower() == "prefix" else 2
    return found[position] if position < len(found) else None


def _behind(text: str, path: str) -> Place:
    return place_at(text, len(text), path, len(text))


def _forms() -> str:
    return "A query begins with SELECT, CONSTRUCT, ASK or DESCRIBE."
