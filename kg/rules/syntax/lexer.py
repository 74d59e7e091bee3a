"""Cuts one token at a time out of a rule's text: the terminals of SPARQL 1.2 (sections 19.8 and, for RL, its grammar).

A token is read when the parser comes to it, so that it can say whether a `<` begins an IRI or compares, and whether
`:=` is an assignment or the empty prefix: the parser calls `as_operator` and `as_assignment` where those may stand.
"""

from __future__ import annotations

import re
import sys
from typing import Final

from kg.query.lexer import Kind, Token

__all__ = ["END", "Kind", "Token", "as_assignment", "as_operator", "token_at", "unescape", "unescape_local"]

END: Final = ""
"""The text of the token behind the last."""

_BASE: Final = (
    r"A-Za-z\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c-\u200d\u2070-\u218f"
    r"\u2c00-\u2fef\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
_CHARS: Final = rf"_0-9\u00b7\u0300-\u036f\u203f-\u2040{_BASE}"
_ESCAPE: Final = r"\\(?:u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8})"
_ECHAR: Final = rf"(?:\\[tbnrf\\\"']|{_ESCAPE})"
_LOCAL: Final = rf"(?:[-{_CHARS}:]|%[0-9A-Fa-f]{{2}}|\\[_~.\-!$&'()*+,;=/?\#@%])"
_LOCAL_FIRST: Final = rf"(?:[{_BASE}_0-9:]|%[0-9A-Fa-f]{{2}}|\\[_~.\-!$&'()*+,;=/?\#@%])"
_DOTTED: Final = r"(?:\.++(?={chars}))"
_TOKEN: Final = re.compile(
    rf"""
    (?P<skip>[\x20\t\n\r]+|\#[^\n\r]*)
    | (?P<iri><(?:[^\x00-\x20<>"{{}}|^`\\]|{_ESCAPE})*>)
    | (?P<string>'''(?:'{{0,2}}(?:[^'\\]|{_ECHAR}))*''' | \"\"\"(?:"{{0,2}}(?:[^"\\]|{_ECHAR}))*\"\"\"
        | '(?:[^'\\\n\r]|{_ECHAR})*' | "(?:[^"\\\n\r]|{_ECHAR})*")
    | (?P<variable>[?$][{_BASE}_0-9][{_CHARS}]*)
    | (?P<tag>@[A-Za-z]+(?:-[A-Za-z0-9]+)*(?:--[A-Za-z]+)?)
    | (?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)[eE][+-]?[0-9]+|[0-9]*\.[0-9]+|[0-9]+)
    | (?P<name>_:[{_BASE}_0-9](?:[-{_CHARS}]|{_DOTTED.format(chars=rf"[-{_CHARS}]")})*
        | (?:[{_BASE}](?:[-{_CHARS}]|{_DOTTED.format(chars=rf"[-{_CHARS}]")})*)?
          :(?:{_LOCAL_FIRST}(?:{_LOCAL}|{_DOTTED.format(chars=_LOCAL)})*)?)
    | (?P<word>[A-Za-z_][A-Za-z0-9_]*)
    | (?P<sign>\^\^|&&|\|\||!=|>=|<=|<<\(|\)>>|<<|>>|\{{\||\|\}}|.)
    """,
    re.VERBOSE | re.DOTALL,
)
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


def token_at(text: str, position: int) -> Token:
    """Return the first token at or behind `position`; one with the text `END` when there is none."""
    while match := _TOKEN.match(text, position):
        position = match.end()
        if match.lastgroup != "skip":
            return Token(_KINDS[str(match.lastgroup)], match.group(), match.start(), match.end())
    return Token(Kind.SIGN, END, len(text), len(text))


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
    return re.sub(r"\\(.)", r"\1", name)


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
