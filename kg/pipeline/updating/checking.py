"""Check an update before anything runs: syntax, and operations that would harm the engine."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import pyoxigraph

from kg.errors import QueryError
from kg.pipeline.updating.operations import Operation, operations
from kg.query.guard import check
from kg.syntax.lexer import Kind, Token, normalise, tokens
from kg.syntax.names import PREFIXES
from kg.syntax.position import place_at

_FAILING: Final = "CLEAR GRAPH <urn:kg:no-such-graph>; "
"""Prefix to an update that makes the engine parse all operations but run none, as this one fails first."""
_NESTING: Final = frozenset({"(", ")", "[", "]", "<<", ">>"})


def parsed(text: str, path: str, base: str | None) -> tuple[str, list[Operation]]:
    """Return an update with normalised line ends, and its operations.

    Raises:
        QueryError: KG501 with the place of a syntax error; KG502 for calls of another server; KG516 for too much
            nesting or chaining.
    """
    text = normalise(text)
    for part in _guarded(text):
        check(part, text, path)
    try:
        parts = list(operations(text, path, base))
    except QueryError as unusual:
        raise _explained(text, path, base) or unusual from None
    if not parts:
        problem = _explained(text, path, base)
        if problem:
            raise problem
    elif not _is_sound(text, parts[0].begin, base):
        _check_each(parts, text, path, base)
    return text, parts


def _check_each(parts: list[Operation], text: str, path: str, base: str | None) -> None:
    """Have the engine parse each operation separately, as it ignores prologues after the first one."""
    labels: dict[str, Operation] = {}
    for number, operation in enumerate(parts):
        alone = _alone(text, parts[: number + 1])
        if not _is_sound(alone, operation.begin, base):
            problem = _explained(alone, path, base)
            if problem:
                # The line is shown as the user typed it: earlier operations are blanked in `alone`.
                if problem.place is not None and problem.place.line is not None:
                    line = text.split("\n")[problem.place.line - 1]
                    problem.place = replace(problem.place, excerpt=line)
                raise problem
        for token in tokens(text[operation.begin : operation.end]):
            if token.text.startswith("_:") and labels.setdefault(token.text, operation) is not operation:
                message = f"the blank node `{token.text}` is that of another operation"
                place = place_at(text, operation.begin + token.start, path, operation.begin + token.end)
                raise QueryError("KG501", message, place=place)


def _alone(text: str, parts: list[Operation]) -> str:
    """Return the last of some operations with all earlier declarations, every character at its original offset."""
    *earlier, last = parts
    signs = list(text[: last.end])
    for operation in earlier:
        for at in range(operation.begin, operation.end):
            signs[at] = "\n" if signs[at] == "\n" else " "
    return "".join(signs)


def _is_sound(text: str, begin: int, base: str | None) -> bool:
    """Return whether the engine can parse an update whose first operation is at `begin`; nothing is executed."""
    try:
        pyoxigraph.Store().update(text[:begin] + _FAILING + text[begin:], base_iri=base, prefixes=dict(PREFIXES))
    except SyntaxError:
        return False
    except (RuntimeError, OSError):
        return True
    return True


def _explained(text: str, path: str, base: str | None) -> QueryError | None:
    """Return the error about an update that the engine cannot parse; None if it can."""

    def parse(beginning: str) -> None:
        pyoxigraph.Store().update(beginning, base_iri=base, prefixes=dict(PREFIXES))

    try:
        parse(text)
    except SyntaxError as error:
        from kg.query.syntax import syntax_error  # noqa: PLC0415 - only errors need it

        return syntax_error(error, text, path, parse)
    except (RuntimeError, OSError):
        return None
    return None


def _guarded(text: str) -> Iterator[list[Token]]:
    """Yield the tokens of each operation that the guard checks; data may have any number of signs and graphs."""
    lexed: list[Token] = []
    depth = 0
    data = False
    for token in tokens(text):
        sign = token.text if token.kind is Kind.SIGN else ""
        if depth == 0:
            data = sign == "{" and bool(lexed) and lexed[-1].text.lower() == "data"
        depth = max(0, depth + (sign == "{") - (sign == "}"))
        outer = depth == (sign == "{")
        if sign == ";" and depth == 0:
            yield lexed
            lexed = []
        elif not data or outer or sign in _NESTING:
            lexed.append(token)
    yield lexed
