"""Cuts one token at a time out of a rule's text: the terminals of SPARQL 1.2 (sections 19.8 and, for RL, its grammar).

A token is read when the parser comes to it, so that it can say whether a `<` begins an IRI or compares, and whether
`:=` is an assignment or the empty prefix: the parser calls `as_operator` and `as_assignment` where those may stand.
"""

from __future__ import annotations

import re
import sys
from functools import lru_cache
from typing import Final

from kg.query.lexer import Kind, Token

__all__ = [
    "END",
    "Kind",
    "Token",
    "as_assignment",
    "as_operator",
    "token_at",
    "tokens_of",
    "unescape",
    "unescape_local",
]

END: Final = ""
"""The text of the token behind the last."""

_KEPT: Final = 1024
"""So many texts are kept in tokens: decomposition asks some twenty times about each expression of a rule."""

# The characters of names are told by those that are none: the fewer a set has, the sooner it is compiled.
_NEVER: Final = (
    r"\x00-\x2c./;-@\[-\^`\x7b-\u00b6\u00b8-\u00bf\u00d7\u00f7\u037e\u2000-\u200b\u200e-\u203e\u2041-\u206f"
    r"\u2190-\u2bff\u2ff0-\u3000\ud800-\uf8ff\ufdd0-\ufdef\ufffe-\uffff\U000f0000-\U0010ffff"
)
"""No name has these, outside of escapes and but for the full stop."""
_NEVER_FIRST: Final = rf"{_NEVER}\u00b7\u0300-\u036f\u203f-\u2040"
_CHAR: Final = rf"[^{_NEVER}:]"
_ESCAPE: Final = r"\\(?:u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8})"
_ECHAR: Final = rf"(?:\\[tbnrf\\\"']|{_ESCAPE})"
_IN_LOCAL: Final = r"%[0-9A-Fa-f]{2}|\\[_~.\-!$&'()*+,;=/?\#@%]"
_LOCAL: Final = rf"(?:[^{_NEVER}]|{_IN_LOCAL})"
_TOKEN: Final = rf"""
    (?:[\x20\t\n\r]++|\#[^\n\r]*+)*+
    (?:(?P<iri><(?:[^\x00-\x20<>"{{}}|^`\\]++|{_ESCAPE})*+>)
    | (?P<string>'''(?:'{{0,2}}(?:[^'\\]|{_ECHAR}))*''' | \"\"\"(?:"{{0,2}}(?:[^"\\]|{_ECHAR}))*\"\"\"
        | '(?:[^'\\\n\r]++|{_ECHAR})*+' | "(?:[^"\\\n\r]++|{_ECHAR})*+")
    | (?P<variable>[?$][^{_NEVER_FIRST}:-][^{_NEVER}:-]*+)
    | (?P<tag>@[A-Za-z]+(?:-[A-Za-z0-9]+)*(?:--[A-Za-z]+)?)
    | (?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)[eE][+-]?[0-9]+|[0-9]*\.[0-9]+|[0-9]+)
    | (?P<name>_:[^{_NEVER_FIRST}:-](?:{_CHAR}++|\.++(?={_CHAR}))*+
        | (?:[^{_NEVER_FIRST}_0-9:-](?:{_CHAR}++|\.++(?={_CHAR}))*+)?
          :(?:(?:[^{_NEVER_FIRST}-]|{_IN_LOCAL})(?:{_LOCAL}|\.++(?={_LOCAL}))*+)?)
    | (?P<word>[A-Za-z_][A-Za-z0-9_]*)
    | (?P<sign>\^\^|&&|\|\||!=|>=|<=|<<\(|\)>>|<<|>>|\{{\||\|\}}|.))
    """
_KINDS: Final = {
    "iri": Kind.IRI,
    "string": Kind.STRING,
    "variable": Kind.VARIABLE,
    "tag": Kind.TAG,
    "number": Kind.NUMBER,
    "name": Kind.NAME,
    "word": Kind.WORD,
    "sign": Kind.SIGN,
}
_SHORT: Final = {"t": "\t", "b": "\b", "n": "\n", "r": "\r", "f": "\f"}
_UNESCAPE: Final = re.compile(r"\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))", re.DOTALL)


@lru_cache(maxsize=1)
def _token() -> re.Pattern[str]:
    """Return the expression for a token. Rules that are kept compiled are evaluated without it."""
    return re.compile(_TOKEN, re.VERBOSE | re.DOTALL)


def token_at(text: str, position: int) -> Token:
    """Return the first token at or behind `position`; one with the text `END` when there is none."""
    match = _token().match(text, position)
    if match is None or match.lastgroup is None:
        return Token(Kind.SIGN, END, len(text), len(text))
    kind = match.lastgroup
    start, end = match.span(kind)
    return Token(_KINDS[kind], text[start:end], start, end)


@lru_cache(maxsize=_KEPT)
def tokens_of(text: str) -> tuple[Token, ...]:
    """Return all tokens of a text, as they are where nothing is known of what stands around them."""
    found = []
    token = token_at(text, 0)
    while token.text != END:
        found.append(token)
        token = token_at(text, token.end)
    return tuple(found)


def as_operator(token: Token) -> Token:
    """Return what an IRI or the beginning of a triple term is where an operator stands: `<` or `<=`."""
    if not token.text.startswith("<"):
        return token
    sign = "<=" if token.text.startswith("<=") else "<"
    return Token(Kind.SIGN, sign, token.start, token.start + len(sign))


def as_assignment(token: Token, text: str) -> Token:
    """Return what the empty prefix is where `:=` stands."""
    if token.kind is Kind.NAME and text.startswith(":=", token.start):
        return Token(Kind.SIGN, ":=", token.start, token.start + 2)
    return token


def unescape(text: str) -> str:
    r"""Return the characters that a string or an IRI stands for.

    Raises ValueError when an escape such as `\UFFFFFFFF` or a surrogate is no character.
    """
    return _UNESCAPE.sub(_character, text) if "\\" in text else text


def unescape_local(name: str) -> str:
    """Return a local name without the backslashes before its punctuation."""
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
