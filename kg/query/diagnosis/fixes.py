"""Edits that fix problems of a query."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.query.syntax import keywords_meant
from kg.similar import similar
from kg.syntax.lexer import Kind, Token
from kg.syntax.names import PREFIXES, WELL_KNOWN
from kg.syntax.prologue import declaration

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.query.completion.outline import Outline


def replacing(token: Token, names: Iterable[str]) -> list[dict[str, Any]]:
    """Return a fix for each of the names that may replace a token."""
    return [_fix(f"Replace by `{name}`", [_edit(token.start, token.end, name)]) for name in names]


def of_token(text: str, token: Token, known: Outline, declared: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return fixes for the first unexpected token of a query; `declared` contains the prefixes of the store."""
    if token.kind is Kind.WORD:
        return replacing(token, keywords_meant(token.text))
    prefix, _, local = token.text.partition(":")
    if token.kind is not Kind.NAME or prefix in known.prefixes or prefix in PREFIXES:
        return []
    return [*_declaring(text, prefix, declared), *replacing(token, _prefixed(prefix, local, known))]


def _declaring(text: str, prefix: str, declared: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    namespace = declared.get(prefix) or WELL_KNOWN.get(prefix)
    if namespace:
        at, line = declaration(text, {prefix: namespace})
        yield _fix(f"Declare `{prefix}:` as <{namespace}>", [_edit(at, at, line)])


def _prefixed(prefix: str, local: str, known: Outline) -> list[str]:
    names = [f"{name}:" for name in (*known.prefixes, *PREFIXES)]
    return [f"{name}{local}" for name in similar(f"{prefix}:", names)]


def closing(text: str, known: Outline) -> list[dict[str, Any]]:
    """Return a fix that closes the open brackets at the end of a query."""
    missing = " ".join(frame.closes for frame in reversed(known.frames) if frame.closes)
    end = len(text.rstrip())
    return [_fix(f"Add `{missing}`", [_edit(end, end, f" {missing}")])] if missing else []


def _fix(title: str, edits: list[dict[str, Any]]) -> dict[str, Any]:
    return {"title": title, "edits": edits}


def _edit(start: int, end: int, text: str) -> dict[str, Any]:
    return {"start": start, "end": end, "text": text}
