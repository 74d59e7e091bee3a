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
_BETWEEN = re.compile(r"(?:[\x20\t\n\r]+|#[^\n\r]*)*+")
"""Blanks and comments."""
_TOKEN = re.compile(
    rf"""
    (?: (?P<string>'''(?:'{{0,2}}(?:[^'\\]|\\.))*''' | \"\"\"(?:"{{0,2}}(?:[^"\\]|\\.))*\"\"\"
        | '(?:[^'\\\n\r]|\\.)*' | "(?:[^"\\\n\r]|\\.)*")
    | (?P<variable>[?$]\w[\w·‿⁀]*)
    | (?P<tag>@[A-Za-z]+(?:-[A-Za-z0-9]+)*)
    | (?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
    | (?P<name>(?:_|[^\W\d_](?:[\w·‿⁀.-]{{0,200}}[\w·‿⁀-])?)?
        :(?:{_NAME_CHARS}(?:{_NAME_CHARS}|\.++(?={_NAME_CHARS}))*)?)
    | (?P<word>[^\W\d]\w*)
    | (?P<sign>\^\^|&&|\|\||[!<>]=|.)
    )(?:[\x20\t\n\r]+|\#[^\n\r]*)*+
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
_OPENING: Final = frozenset({"{", "[", "<<"})
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
    previous: tuple[Token, ...] = ()
    position = _behind(text, 0)
    while position < len(text):
        token = _angle(text, position, levels[-1], previous) if text[position] in "<>" else None
        if token is not None:
            position = _behind(text, token.end)
        else:
            match = _TOKEN.match(text, position)
            if match is None or (group := match.lastgroup) is None:
                break
            token = Token(_KINDS[group], match[group], position, match.end(group))
            position = match.end()
        yield token
        if token.kind is Kind.SIGN or token.kind is Kind.WORD:
            _track(token, levels, previous)
        previous = (*previous[-1:], token)


def _behind(text: str, position: int) -> int:
    """Return where the next token begins."""
    match = _BETWEEN.match(text, position)
    return match.end() if match else position


def _angle(text: str, position: int, level: _Level, previous: tuple[Token, ...]) -> Token | None:
    """Return the IRI, the operator, or the beginning or end of a quoted triple at a `<` or `>`; None for others."""
    if text[position] == ">":
        closes = level.bracket == "<<" and text.startswith(">>", position)
        return Token(Kind.SIGN, ">>", position, position + 2) if closes else None
    if level.expression and level.bracket == "(" and previous and _is_operand(previous[-1]):
        end = position + (2 if text.startswith("<=", position) else 1)
        return Token(Kind.SIGN, text[position:end], position, end)
    match = _IRI.match(text, position)
    if match:
        return Token(Kind.IRI, match.group(), position, match.end())
    if text.startswith("<<", position):
        return Token(Kind.SIGN, "<<", position, position + 2)
    return None


def _is_operand(token: Token) -> bool:
    if token.kind is Kind.WORD:
        return token.text.lower() in _TERM_WORDS
    return token.kind is not Kind.SIGN or token.text in {")", "]", "}", ">>"}


def _track(token: Token, levels: list[_Level], previous: tuple[Token, ...]) -> None:
    """Follow brackets and clauses by a sign or a word; they decide where expressions stand."""
    level = levels[-1]
    if token.kind is Kind.WORD:
        word = token.text.lower()
        if word in _BEGIN_EXPRESSIONS and level.bracket in {"", "{"}:
            level.expression = True
        elif word in _END_EXPRESSIONS and level.bracket in {"", "{"}:
            level.expression = level.bracket == ""
    elif token.text in _OPENING:
        levels.append(_Level(token.text, expression=False))
        if token.text == "{" and level.bracket == "{":
            level.expression = False
    elif token.text == "(":
        levels.append(_Level("(", expression=_opens_expression(level, previous)))
    elif _CLOSING.get(token.text) == level.bracket != "":
        levels.pop()


def _opens_expression(level: _Level, previous: tuple[Token, ...]) -> bool:
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
