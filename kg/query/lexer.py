"""Splits a SPARQL query or update into tokens, as its grammar does (SPARQL 1.1 Query Language, section 19.8).

Only what guards and the binding of parameters need is told apart. The one hard case is `<`: it begins an IRI, or
is the operator, in which case quotes, brackets and `#` behind it are code. An operand stands before the operator
and the innermost bracket is one of an expression; an IRI can stand behind an operand only where terms follow each
other without operators (triples, lists, rows of VALUES). So brackets are told apart by what stands before them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Kind", "Token", "normalise", "tokens"]


class Kind(Enum):
    """What a token is."""

    IRI = auto()
    STRING = auto()
    VARIABLE = auto()
    NAME = auto()
    """A prefixed name or the label of a blank node."""
    WORD = auto()
    """A keyword or the name of a built-in function; also `a`, `true` and `false`."""
    NUMBER = auto()
    TAG = auto()
    """A language tag."""
    SIGN = auto()
    """A bracket, an operator or punctuation."""


class Token(NamedTuple):
    """A token with the offsets of its first character and of the one behind its last."""

    kind: Kind
    text: str
    start: int
    end: int


_IRI = re.compile(r"<(?:[^\x00-\x20<>\"{}|^`\\]|\\u[0-9A-Fa-f]{4}|\\U[0-9A-Fa-f]{8})*>")
_NAME_CHARS = r"(?:[\w·‿⁀-]|%[0-9A-Fa-f]{2}|\\[_~.\-!$&'()*+,;=/?#@%]|:)"
_TOKEN = re.compile(
    rf"""
    (?P<skip>[\x20\t\n\r]+|\#[^\n\r]*)
    | (?P<string>'''(?:'{{0,2}}(?:[^'\\]|\\.))*''' | \"\"\"(?:"{{0,2}}(?:[^"\\]|\\.))*\"\"\"
        | '(?:[^'\\\n\r]|\\.)*' | "(?:[^"\\\n\r]|\\.)*")
    | (?P<variable>[?$]\w[\w·‿⁀]*)
    | (?P<tag>@[A-Za-z]+(?:-[A-Za-z0-9]+)*)
    | (?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
    | (?P<name>(?:_|[^\W\d_](?:[\w·‿⁀.-]{{0,200}}[\w·‿⁀-])?)?
        :(?:{_NAME_CHARS}(?:{_NAME_CHARS}|\.++(?={_NAME_CHARS}))*)?)
    | (?P<word>[^\W\d]\w*)
    | (?P<sign>\^\^|&&|\|\||[!<>]=|.)
    """,
    re.VERBOSE | re.DOTALL,
)
_KINDS = {
    "string": Kind.STRING,
    "variable": Kind.VARIABLE,
    "tag": Kind.TAG,
    "number": Kind.NUMBER,
    "name": Kind.NAME,
    "word": Kind.WORD,
    "sign": Kind.SIGN,
}
_CLOSING: Final = {")": "(", "]": "[", "}": "{", ">>": "<<"}
_TERM_WORDS: Final = frozenset({"a", "true", "false", "undef"})
_BEGIN_EXPRESSIONS: Final = frozenset({"select", "group", "order", "having"})
_END_EXPRESSIONS: Final = frozenset({"where", "from", "limit", "offset", "values"})


@dataclass(slots=True)
class _Level:
    """An open bracket: `expression` tells whether operands need operators between them in it."""

    bracket: str
    expression: bool


def normalise(text: str) -> str:
    """Return `text` with all ends of lines as line feeds, so that lexer and engine agree on where comments end."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def tokens(text: str) -> Iterator[Token]:
    """Yield the tokens of a normalised query without blanks and comments; nothing is refused here."""
    levels = [_Level("", expression=True)]
    previous: list[Token] = []
    position = 0
    while position < len(text):
        token = _angle(text, position, levels[-1], previous) if text[position] == "<" else None
        if token is None:
            match = _TOKEN.match(text, position)
            if match is None or match.lastgroup is None:
                break
            position = match.end()
            if match.lastgroup == "skip":
                continue
            token = Token(_KINDS[match.lastgroup], match.group(), match.start(), match.end())
        token = _closing_quoted_triple(text, token, levels[-1])
        position = token.end
        yield token
        _track(token, levels, previous)
        previous = [*previous[-1:], token]


def _angle(text: str, position: int, level: _Level, previous: list[Token]) -> Token | None:
    """Return the IRI, the operator or the beginning of a quoted triple at a `<`."""
    if level.expression and level.bracket == "(" and previous and _is_operand(previous[-1]):
        end = position + (2 if text.startswith("<=", position) else 1)
        return Token(Kind.SIGN, text[position:end], position, end)
    match = _IRI.match(text, position)
    if match:
        return Token(Kind.IRI, match.group(), position, match.end())
    if text.startswith("<<", position):
        return Token(Kind.SIGN, "<<", position, position + 2)
    return None


def _closing_quoted_triple(text: str, token: Token, level: _Level) -> Token:
    if level.bracket == "<<" and token.text == ">" and text.startswith(">>", token.start):
        return Token(Kind.SIGN, ">>", token.start, token.start + 2)
    return token


def _is_operand(token: Token) -> bool:
    if token.kind is Kind.WORD:
        return token.text.lower() in _TERM_WORDS
    return token.kind is not Kind.SIGN or token.text in {")", "]", "}", ">>"}


def _track(token: Token, levels: list[_Level], previous: list[Token]) -> None:
    """Follow brackets and the clauses of a query, which decide where expressions stand."""
    level = levels[-1]
    if token.kind is Kind.WORD:
        word = token.text.lower()
        if word in _BEGIN_EXPRESSIONS and level.bracket in {"", "{"}:
            level.expression = True
        elif word in _END_EXPRESSIONS and level.bracket in {"", "{"}:
            level.expression = level.bracket == ""
    elif token.kind is Kind.SIGN and token.text in {"{", "[", "<<"}:
        levels.append(_Level(token.text, expression=False))
        if token.text == "{" and level.bracket == "{":
            level.expression = False
    elif token.kind is Kind.SIGN and token.text == "(":
        levels.append(_Level("(", expression=_opens_expression(level, previous)))
    elif token.kind is Kind.SIGN and _CLOSING.get(token.text) == level.bracket != "":
        levels.pop()


def _opens_expression(level: _Level, previous: list[Token]) -> bool:
    """Tell whether a `(` in `level`, behind the tokens `previous`, holds an expression (or arguments)."""
    if not previous:
        return True
    last = previous[-1]
    if last.text == "<<" or level.bracket == "<<":
        return False
    if level.expression:
        return True
    if last.kind is Kind.WORD:
        return last.text.lower() not in _TERM_WORDS
    called = last.kind in {Kind.NAME, Kind.IRI} and len(previous) > 1
    return called and previous[-2].kind is Kind.WORD and previous[-2].text.lower() not in _TERM_WORDS
