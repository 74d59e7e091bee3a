"""The engine's complaints about a query, told with place, line and what was probably meant."""

from __future__ import annotations

import itertools
import re
from typing import TYPE_CHECKING

import pyoxigraph

from kg.errors import QueryError
from kg.query.lexer import Kind, tokens
from kg.query.position import place_at, place_of
from kg.query.prefixes import PREFIXES
from kg.query.similar import did_you_mean

if TYPE_CHECKING:
    from kg.query.lexer import Token

__all__ = ["syntax_error"]

_POSITION = re.compile(r"error at (\d+):(\d+): expected (.*)", re.DOTALL)
_SENTENCE = re.compile(r"(?:^|one of |, )([A-Z][a-z]+ [A-Za-z][^\[\]\"']*?)(?=, |$)")
_BLANKS = 64
"""More than the longest keyword."""
_FORMS = ("SELECT", "CONSTRUCT", "ASK", "DESCRIBE")
_UPDATES = frozenset({"insert", "delete", "load", "clear", "create", "drop", "copy", "move", "add"})


def syntax_error(error: SyntaxError, text: str, path: str) -> QueryError:
    """Return KG501 for the engine's `error` about `text`, at the place of the first token that does not fit.

    Of what the engine says only the sentences are kept, not what its grammar would have allowed. Two frequent
    mistakes are told by name: undeclared prefixes and updates.
    """
    found = list(tokens(text))
    special = _open_quote(found, text, path) or _undeclared(found, text, path) or _no_query(found, text, path)
    if special:
        return special
    match = _POSITION.match(error.msg)
    if match is None:
        return QueryError("KG501", error.msg, place=place_of(text, 1, 1, path))
    line, column = int(match[1]), int(match[2])
    sentence = _SENTENCE.search(match[3])
    if sentence:
        message = sentence[1][0].lower() + sentence[1][1:]
        return QueryError("KG501", message, place=place_of(text, line, column, path))
    culprit = _first_misfit(found, text, _offset(text, line, column))
    if culprit is None:
        return QueryError("KG501", "the query ends too early", place=place_at(text, len(text), path))
    return QueryError("KG501", f"`{culprit.text}` is not expected here", place=place_at(text, culprit.start, path))


def _offset(text: str, line: int, column: int) -> int:
    offset = 0
    for _ in range(line - 1):
        offset = text.index("\n", offset) + 1
    return offset + column - 1


def _first_misfit(found: list[Token], text: str, reported: int) -> Token | None:
    """Return the first token that cannot stand where it stands; None when only more text is missing.

    The engine compares keywords by their length and reports where a keyword that did not match would have ended, so
    its place lies up to a keyword behind the misfit. A beginning of the query is good when the engine, given that
    beginning, blanks longer than any keyword and a character that fits nowhere, gets as far as that character.
    """
    misfit = None
    for token in reversed([token for token in found if token.start <= reported]):
        if _reaches_end(text[: token.end]):
            return misfit or next((later for later in found if later.start > token.start), None)
        misfit = token
    return misfit


def _reaches_end(beginning: str) -> bool:
    """Tell whether the engine can parse all of the `beginning` of a query."""
    try:
        pyoxigraph.Store().query(beginning + " " * _BLANKS + "\0", prefixes=dict(PREFIXES))
    except SyntaxError as error:
        match = _POSITION.match(error.msg)
        return match is None or _offset(beginning, int(match[1]), int(match[2])) >= len(beginning) + _BLANKS
    return True


def _open_quote(found: list[Token], text: str, path: str) -> QueryError | None:
    for token in found:
        if token.kind is Kind.SIGN and token.text in {"'", '"'}:
            return QueryError("KG501", "this quote is never closed", place=place_at(text, token.start, path))
    return None


def _undeclared(found: list[Token], text: str, path: str) -> QueryError | None:
    """Return the error about the first prefix that nothing declares."""
    declared = set(PREFIXES)
    for before, token in itertools.pairwise(found):
        if before.text.lower() == "prefix" and token.kind is Kind.NAME:
            declared.add(token.text.partition(":")[0])
    for token in found:
        prefix = token.text.partition(":")[0]
        if token.kind is Kind.NAME and prefix != "_" and prefix not in declared:
            hint = did_you_mean(f"{prefix}:", [f"{name}:" for name in declared])
            hint = hint or f"Declare it: PREFIX {prefix}: <...>"
            place = place_at(text, token.start, path)
            return QueryError("KG501", f"the prefix `{prefix}:` is not declared", place=place, hint=hint)
    return None


def _no_query(found: list[Token], text: str, path: str) -> QueryError | None:
    """Return the error about a text that begins with no form of query."""
    position = 0
    while position < len(found) and found[position].text.lower() in {"prefix", "base"}:
        position += 3 if found[position].text.lower() == "prefix" else 2
    if position >= len(found):
        return QueryError("KG501", "there is no query", place=place_at(text, len(text), path), hint=_forms())
    token = found[position]
    if token.text.upper() in _FORMS:
        return None
    place = place_at(text, token.start, path)
    if token.text.lower() in _UPDATES:
        return QueryError("KG501", "this is an update, not a query", place=place, hint=_forms())
    hint = did_you_mean(token.text, _FORMS) if token.kind is Kind.WORD else None
    return QueryError("KG501", f"a query does not begin with `{token.text}`", place=place, hint=hint or _forms())


def _forms() -> str:
    return "A query begins with SELECT, CONSTRUCT, ASK or DESCRIBE."
