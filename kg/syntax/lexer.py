r"""Lexer of SPARQL: the terminals of SPARQL 1.2 (section 19.8) and of its rule language.

It has two uses. A parser reads one token at a time (`token_at`) and knows from its grammar whether a `<` begins an IRI
or compares, and whether `:=` assigns: it calls `as_operator` and `as_assignment` there. All other code reads the tokens
of a whole text, valid or not (`tokens`), where the context decides about `<`: it is an operator after an operand if the
innermost bracket is that of an expression. Elsewhere terms follow each other without operators (triples, lists, rows of
VALUES). So the kind of a bracket follows from the tokens before it.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from functools import lru_cache
from typing import Final, NamedTuple


class Kind(Enum):
    """The kind of a token."""

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
    """A token with its start and end offsets."""

    kind: Kind
    text: str
    start: int
    end: int


END: Final = ""
"""The text of the end token."""

_KEPT: Final = 1024
"""Number of texts whose tokens are cached: decomposition reads each expression some twenty times."""

# Names are defined by excluded characters: smaller sets compile faster.
_NEVER_ASCII: Final = r"\x00-\x2c./;-@\[-\^`\x7b-\x7f"
_NEVER: Final = (
    rf"{_NEVER_ASCII}\x80-\u00b6\u00b8-\u00bf\u00d7\u00f7\u037e\u2000-\u200b\u200e-\u203e\u2041-\u206f"
    r"\u2190-\u2bff\u2ff0-\u3000\ud800-\uf8ff\ufdd0-\ufdef\ufffe-\uffff\U000f0000-\U0010ffff"
)
"""Characters that names cannot contain, except in escapes and for the full stop."""
_NEVER_FIRST: Final = rf"{_NEVER}\u00b7\u0300-\u036f\u203f-\u2040"
_IRI_ESCAPE: Final = r"\\(?:u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8})"
_IN_LOCAL: Final = r"%[0-9A-Fa-f]{2}|\\[_~.\-!$&'()*+,;=/?\#@%]"
_KINDS: Final = {kind.name: kind for kind in Kind}
_SHORT: Final = {"t": "\t", "b": "\b", "n": "\n", "r": "\r", "f": "\f"}
_UNESCAPE: Final = re.compile(r"\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))", re.DOTALL)
_ESCAPED: Final = re.compile(rf"(?:[^\\]++|\\[tbnrf\\\"']|{_IRI_ESCAPE})*+")


@lru_cache(maxsize=4)
def _terminal(*, ascii_only: bool, prefixes: bool = True) -> re.Pattern[str]:
    """Return the pattern of a token, or one without names with a prefix.

    The variants for ASCII texts compile five times as fast.
    """
    never, first = (_NEVER_ASCII, _NEVER_ASCII) if ascii_only else (_NEVER, _NEVER_FIRST)
    char, local = f"[^{never}:]", f"(?:[^{never}]|{_IN_LOCAL})"
    prefix = rf"(?:[^{first}_0-9:-](?:{char}++|\.++(?={char}))*+)?" if prefixes else ""
    return re.compile(
        rf"""
    (?:[\x20\t\n\r]++|\#[^\n\r]*+)*+
    (?:(?P<IRI><(?:[^\x00-\x20<>"{{}}|^`\\]++|{_IRI_ESCAPE})*+>)
    | (?P<STRING>'''(?:'{{0,2}}(?:[^'\\]|\\.))*''' | \"\"\"(?:"{{0,2}}(?:[^"\\]|\\.))*\"\"\"
        | '(?:[^'\\\n\r]++|\\.)*+' | "(?:[^"\\\n\r]++|\\.)*+")
    | (?P<VARIABLE>[?$][^{first}:-][^{never}:-]*+)
    | (?P<TAG>@[A-Za-z]+(?:-[A-Za-z0-9]+)*(?:--[A-Za-z]+)?)
    | (?P<NUMBER>(?:[0-9]+\.?[0-9]*|\.[0-9]+)[eE][+-]?[0-9]+|[0-9]*\.[0-9]+|[0-9]+)
    | (?P<NAME>_:[^{first}:-](?:{char}++|\.++(?={char}))*+
        | {prefix}:(?:(?:[^{first}-]|{_IN_LOCAL})(?:{local}|\.++(?={local}))*+)?)
    | (?P<WORD>[^\W\d]\w*)
    | (?P<SIGN>\^\^|&&|\|\||!=|>=|<=|<<\(|\)>>|<<|>>|\{{\||\|\}}|.))
    """,
        re.VERBOSE | re.DOTALL,
    )


@lru_cache(maxsize=2)
def _run(*, ascii_only: bool) -> re.Pattern[str]:
    """Return the pattern of the characters that a prefix can contain."""
    char = f"[^{_NEVER_ASCII if ascii_only else _NEVER}:]"
    return re.compile(rf"(?:{char}++|\.++(?={char}))*+")


class _Scanner:
    """Reads the tokens of a text in order, in linear time.

    `a.a.a` could begin a prefix at every letter, each with the same end. If no colon is there, the pattern without
    prefixes matches the same tokens and does not look ahead again.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._ascii_only = text.isascii()
        self._match = _terminal(ascii_only=self._ascii_only).match
        self._run_end = 0
        self._prefix = True

    def token_at(self, position: int) -> Token:
        """Return the first token at or after a position, which is at least the last one; `END` at the end."""
        following = self._text[position : position + 1]
        if position >= self._run_end and (following in {".", "-"} or following > "\x7f"):
            run = _run(ascii_only=self._ascii_only).match(self._text, position)
            self._run_end = run.end() if run else position
            self._prefix = self._text.startswith(":", self._run_end)
        if position < self._run_end and not self._prefix:
            return _token(
                _terminal(ascii_only=self._ascii_only, prefixes=False).match(self._text, position), self._text
            )
        return _token(self._match(self._text, position), self._text)


def _token(match: re.Match[str] | None, text: str) -> Token:
    if match is None or (kind := match.lastgroup) is None:
        return Token(Kind.SIGN, END, len(text), len(text))
    start, end = match.span(kind)
    return Token(_KINDS[kind], text[start:end], start, end)


def token_at(text: str, position: int) -> Token:
    """Return the first token at or after `position`; one with the text `END` at the end."""
    return _token(_terminal(ascii_only=text.isascii()).match(text, position), text)


@lru_cache(maxsize=_KEPT)
def tokens_of(text: str) -> tuple[Token, ...]:
    """Return all tokens of a text, without regard to context."""
    result = []
    scanner = _Scanner(text)
    token = scanner.token_at(0)
    while token.text != END:
        result.append(token)
        token = scanner.token_at(token.end)
    return tuple(result)


@lru_cache(maxsize=_KEPT)
def bare(text: str) -> str:
    """Return an expression without brackets around all of it; strings and IRIs are not searched for brackets."""
    inner = tokens_of(text)
    while len(inner) > 2 and inner[0].text == "(" and partner(inner) == len(inner) - 1:  # noqa: PLR2004 - both brackets and more
        inner = inner[1:-1]
    return text[inner[0].start : inner[-1].end] if inner else text


def partner(sequence: Sequence[Token]) -> int:
    """Return the index of the bracket that closes the first of some tokens, -1 if none does."""
    depth = 0
    for index, token in enumerate(sequence):
        depth += (token.text in {"(", "[", "{"}) - (token.text in {")", "]", "}"})
        if depth == 0:
            return index
    return -1


def as_operator(token: Token) -> Token:
    """Return an IRI or the start of a triple term as an operator, `<` or `<=`."""
    return _cut(token, "<=" if token.text.startswith("<=") else "<") if token.text.startswith("<") else token


def as_assignment(token: Token, text: str) -> Token:
    """Return the empty prefix as `:=`."""
    if token.kind is Kind.NAME and text.startswith(":=", token.start):
        return _cut(token, ":=")
    return token


def as_written(token: Token) -> Token:
    """Return only the quote of a string with an invalid escape."""
    if token.kind is Kind.STRING and "\\" in token.text and not _ESCAPED.fullmatch(token.text):
        return _cut(token, token.text[0])
    return token


def _cut(token: Token, sign: str) -> Token:
    return Token(Kind.SIGN, sign, token.start, token.start + len(sign))


def is_name(token: Token) -> bool:
    """Return whether a token is an IRI in brackets or a prefixed name."""
    return token.kind is Kind.IRI or (token.kind is Kind.NAME and not token.text.startswith("_:"))


def iri_of(token: Token, prefixes: Mapping[str, str]) -> str | None:
    """Return the IRI of a name; None for an unknown prefix."""
    if token.kind is Kind.IRI:
        return token.text[1:-1]
    prefix, _, local = token.text.partition(":")
    return prefixes[prefix] + unescape_local(local) if prefix in prefixes else None


def quoted(token: Token) -> tuple[int, str]:
    """Return the number of quotes at each end of a string, and its raw content."""
    quotes = 3 if token.text.startswith(("'''", '"""')) else 1
    return quotes, token.text[quotes:-quotes]


def unescape(text: str) -> str:
    r"""Return the unescaped characters of a string or an IRI.

    Raises ValueError if an escape, such as `\UFFFFFFFF` or a surrogate, is not a character.
    """
    return _UNESCAPE.sub(_character, text) if "\\" in text else text


def unescape_local(name: str) -> str:
    """Return a local name without the backslashes before punctuation."""
    return re.sub(r"\\(.)", r"\1", name) if "\\" in name else name


def _character(match: re.Match[str]) -> str:
    short = match[3]
    if short is not None:
        return _SHORT.get(short, short)
    number = int(match[1] or match[2], 16)
    if number > sys.maxunicode:
        raise ValueError(number)
    character = chr(number)
    character.encode()
    return character


_OPENING: Final = frozenset({"{", "[", "<<", "<<(", "{|"})
_CLOSING: Final = {")": "(", "]": "[", "}": "{", ">>": "<<", ")>>": "<<(", "|}": "{|"}
_TERM_WORDS: Final = frozenset({"a", "true", "false", "undef"})
_BEGIN_EXPRESSIONS: Final = frozenset({"select", "group", "order", "having"})
_END_EXPRESSIONS: Final = frozenset({"where", "from", "limit", "offset", "values"})


@dataclass(slots=True)
class _Level:
    """An open bracket; `expression` is whether operands in it are separated by operators."""

    bracket: str
    expression: bool


def normalise(text: str) -> str:
    """Return `text` with line feeds as line ends, so lexer and engine agree on the ends of comments."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def tokens(text: str) -> Iterator[Token]:
    """Yield the tokens of a normalised text without whitespace and comments; accepts any text."""
    levels = [_Level("", expression=True)]
    previous: tuple[Token, ...] = ()
    scanner = _Scanner(text)
    while (token := scanner.token_at(previous[-1].end if previous else 0)).text != END:
        if token.text[0] in "<>)|":
            token = _in_context(token, levels[-1], previous)
        yield token
        if token.kind is Kind.SIGN or token.kind is Kind.WORD:
            _track(token, levels, previous)
        previous = (*previous[-1:], token)


def _in_context(token: Token, level: _Level, previous: tuple[Token, ...]) -> Token:
    """Return a `<` after an operand as an operator, and only one character of an unmatched closing bracket."""
    if token.text.startswith("<"):
        compares = level.expression and level.bracket == "(" and previous and _is_operand(previous[-1])
        return as_operator(token) if compares else token
    closes = _CLOSING.get(token.text)
    return token if closes in {None, "(", level.bracket} else _cut(token, token.text[0])


def _is_operand(token: Token) -> bool:
    if token.kind is Kind.WORD:
        return token.text.lower() in _TERM_WORDS
    return token.kind is not Kind.SIGN or token.text in _CLOSING


def _track(token: Token, levels: list[_Level], previous: tuple[Token, ...]) -> None:
    """Update brackets and clauses by a sign or a word; they decide where expressions are."""
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
    """Return whether a `(` in `level`, after the tokens `previous`, begins an expression or arguments."""
    if not previous:
        return True
    last = previous[-1]
    if level.bracket in {"<<", "<<("}:
        return False
    if level.expression:
        return True
    if last.kind is Kind.WORD:
        return last.text.lower() not in _TERM_WORDS
    called = last.kind in {Kind.NAME, Kind.IRI} and len(previous) > 1
    return called and previous[-2].kind is Kind.WORD and previous[-2].text.lower() not in _TERM_WORDS
