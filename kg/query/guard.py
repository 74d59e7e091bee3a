"""Reject queries that would harm the engine or other servers, by their tokens.

The engine parses and plans recursively: a query nested some thousand levels deep overflows the stack and aborts the
process. `SERVICE` and `LOAD` make it call other servers, without permission or time limit.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from kg.errors import QueryError
from kg.syntax.lexer import Kind, Token
from kg.syntax.position import place_at

MAX_DEPTH: Final = 500
"""Maximum nesting of brackets and unary operators."""

MAX_CHAIN: Final = 5000
"""Maximum number of operators and graph patterns; the engine chains them into a tree of that depth."""

_OPENING: Final = frozenset({"(", "[", "{", "<<", "<<(", "{|"})
_CLOSING: Final = frozenset({")", "]", "}", ">>", ")>>", "|}"})
_UNARY: Final = frozenset({"!", "-", "+", "^", "^^"})
_OPERATORS: Final = frozenset({"!", "-", "+", "^", "||", "&&", "*", "/", "|", "=", "!=", "<", ">", "<=", ">="})
_PATTERNS: Final = frozenset({"union", "optional", "minus", "bind", "filter", "graph", "lateral", "exists", "not"})
_INSTEAD: Final = {
    "SERVICE": "Query the other server itself.",
    "LOAD": "Add the file with `kg import` or the graph store protocol.",
}


def check(tokens: Iterable[Token], text: str, path: str = "query") -> None:
    """Reject a query that nests too deeply, chains too much or would call another server.

    Raises QueryError: KG502 for a call, KG516 for depth or length, at the place of the first cause.
    """
    depth = unary = chain = 0
    previous: Token | None = None
    for token in tokens:
        if _is_call(previous, token, depth):
            word = "LOAD" if "load" in token.text.lower() else "SERVICE"
            place = place_at(text, token.start, path, token.end)
            message = f"{word} is disabled: it would call another server"
            raise QueryError("KG502", message, place=place, hint=_INSTEAD[word])
        previous = token
        if token.kind is Kind.SIGN:
            sign = token.text
            depth = max(0, depth + (sign in _OPENING) - (sign in _CLOSING))
            unary = unary + len(sign) if sign in _UNARY else 0
            chain += sign in {"{", "{|"} or sign in _OPERATORS
        else:
            unary = 0
            chain += token.kind is Kind.WORD and token.text.lower() in _PATTERNS
        if depth > MAX_DEPTH or unary > MAX_DEPTH:
            raise _too_much(f"the query nests deeper than {MAX_DEPTH}", text, token, path)
        if chain > MAX_CHAIN:
            raise _too_much(f"the query has more than {MAX_CHAIN} operators and patterns", text, token, path)


def _is_call(previous: Token | None, token: Token, depth: int) -> bool:
    """Return whether the engine may read SERVICE or LOAD here; it needs no whitespace around a keyword."""
    if token.kind is Kind.WORD:
        word = token.text.lower()
        return "service" in word or "load" in word
    if token.text == "{" and previous and previous.kind is Kind.NAME:
        return "service" in _prefix(previous)
    if token.kind is Kind.NAME and depth == 0 and "load" in _prefix(token):
        return previous is None or previous.kind in {Kind.IRI, Kind.NAME} or previous.text in {";", "}"}
    return False


def _prefix(name: Token) -> str:
    return name.text.partition(":")[0].lower()


def _too_much(message: str, text: str, token: Token, path: str) -> QueryError:
    return QueryError("KG516", message, place=place_at(text, token.start, path, token.end))
