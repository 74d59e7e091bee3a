"""Printing of paths, and of SPARQL with some tokens respelt."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pyoxigraph import NamedNode

from kg.syntax.lexer import Kind, Token, tokens_of
from kg.syntax.terms import Variable
from kg.syntax.tree import Alternative, Inverse, Negated, Path, Sequence


def respelt(text: str, spelling: Callable[[Token], str | None]) -> str:
    """Return a text in which `spelling` replaces tokens; None leaves a token unchanged."""
    pieces, end = [], 0
    for token in tokens_of(text):
        new = spelling(token)
        if new is not None:
            pieces += [text[end : token.start], new]
            end = token.end
    return "".join(pieces) + text[end:]


def renamed(text: str, names: Mapping[str, str]) -> str:
    """Return a text with renamed variables, given without `?`; the text may be a whole group."""

    def spelling(token: Token) -> str | None:
        new = names.get(token.text[1:]) if token.kind is Kind.VARIABLE else None
        return None if new is None else f"?{new}"

    return respelt(text, spelling)


def path_text(path: Path, name: Callable[[NamedNode | Variable], str]) -> str:
    """Return a path as SPARQL text; `name` returns the text of predicates."""
    if isinstance(path, NamedNode | Variable):
        return name(path)
    if isinstance(path, Negated):
        return f"!({'|'.join([*map(name, path.forward), *(f'^{name(one)}' for one in path.backward)])})"
    if isinstance(path, Sequence | Alternative):
        return ("/" if isinstance(path, Sequence) else "|").join(_inner(part, name) for part in path.parts)
    if isinstance(path, Inverse):
        return f"^{_inner(path.path, name)}"
    return f"{_inner(path.path, name)}{('+' if path.least else '*') if path.many else '?'}"


def _inner(path: Path, name: Callable[[NamedNode | Variable], str]) -> str:
    text = path_text(path, name)
    return text if isinstance(path, NamedNode | Variable | Negated) else f"({text})"
