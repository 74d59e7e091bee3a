"""`diagnose`: the problems of a query and edits that fix them, the same for all interfaces."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import pyoxigraph

from kg.errors import QueryError
from kg.query.completion.outline import Outline, outline
from kg.query.diagnosis.variables import bound, product, unbound
from kg.query.guard import check
from kg.query.syntax import similar_keywords, syntax_error
from kg.query.terms import unknown
from kg.similar import similar, suggest
from kg.syntax.lexer import Kind, Token, normalise, tokens
from kg.syntax.names import PREFIXES, WELL_KNOWN
from kg.syntax.position import offset_of, place_at
from kg.syntax.prologue import declaration

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.store.interface import Snapshot


def diagnose(
    text: str, snapshot: Snapshot, declared: Mapping[str, str] | None = None, used: Iterable[str] = ()
) -> list[dict[str, Any]]:
    """Return the problems of the query `text`: the first error; warnings if there is none or it is minor.

    Each has `severity` (error or warning), `code`, `message`, `hint` (may be null), the `line` and `column` of its
    first character, `endLine` and `endColumn` after its last, counted from one in code points, and the same as offsets
    `start` and `end`. Its `fixes` have a `title` and `edits` (`start`, `end`, `text`), as offsets in the original text.
    `declared` contains further prefixes to suggest, `used` the IRIs of further terms. A text without tokens has no
    problems.
    """
    if not text.strip():
        return []
    normal = normalise(text)
    lexed = list(tokens(normal))
    error = _error(normal)
    if error is not None:
        problems = [_of_error(error, normal, lexed, declared or {})]
    else:
        outlined = outline(lexed)
        problems = [*_unbound(normal, outlined), *_product(normal, outlined)]
    problems += _unknown(normal, snapshot, used)
    problems.sort(key=lambda problem: problem["start"])
    return [_moved(problem, text) for problem in problems] if len(text) != len(normal) else problems


def _error(text: str) -> QueryError | None:
    try:
        check(tokens(text), text)
        pyoxigraph.Store().query(text, prefixes=dict(PREFIXES))
    except QueryError as error:
        return error
    except SyntaxError as error:
        return syntax_error(error, text, "query")
    except (RuntimeError, ValueError):
        # The query parses; other errors are reported when it runs.
        return None
    return None


def _of_error(error: QueryError, text: str, lexed: list[Token], declared: Mapping[str, str]) -> dict[str, Any]:
    place = error.place
    assert place is not None  # noqa: S101 - errors about a text have one
    start = offset_of(text, place.line or 1, place.column or 1)
    end = start if place.end_line is None else offset_of(text, place.end_line, place.end_column or 1)
    outlined = outline(lexed)
    culprit = next((token for token in lexed if token.start == start), None)
    repairs = _fixes_of(text, culprit, outlined, declared) if culprit else _closing(text, outlined)
    return _problem("error", error, (text, start, end), repairs)


def _unbound(text: str, outlined: Outline) -> Iterator[dict[str, Any]]:
    names = bound(outlined)
    for use in unbound(outlined):
        near = [f"?{name}" for name in get_close_matches(use.name, sorted(names))]
        hint = suggest(near)
        error = QueryError("KG514", f"nothing gives ?{use.name} a value", hint=hint)
        repairs = _replacing(use.token, near)
        yield _problem("warning", error, (text, use.token.start, use.token.end), repairs)


def _product(text: str, outlined: Outline) -> Iterator[dict[str, Any]]:
    second = product(outlined)
    if second is not None:
        message = "nothing joins this with the part before it: every match of one goes with every match of the other"
        hint = "Join them by a variable, or by a FILTER that compares them."
        yield _problem("warning", QueryError("KG515", message, hint=hint), (text, second.start, second.end), [])


def _unknown(text: str, snapshot: Snapshot, used: Iterable[str]) -> Iterator[dict[str, Any]]:
    for each in unknown(snapshot, text, used):
        error = QueryError("KG513", f"`{each.token.text}` is not in the store", hint=suggest(each.suggestions))
        span = (text, each.token.start, each.token.end)
        yield _problem("warning", error, span, _replacing(each.token, each.suggestions))


def _problem(
    severity: str, error: QueryError, span: tuple[str, int, int], repairs: list[dict[str, Any]]
) -> dict[str, Any]:
    text, start, end = span
    place = place_at(text, start, "query", end)
    return {
        "severity": severity,
        "code": error.code,
        "message": error.message,
        "hint": error.hint,
        "line": place.line,
        "column": place.column,
        "endLine": place.end_line,
        "endColumn": place.end_column,
        "start": start,
        "end": end,
        "fixes": repairs,
    }


def _moved(problem: dict[str, Any], text: str) -> dict[str, Any]:
    """Return a problem with its offsets in the original text, before line ends were normalized."""
    offsets = []
    for index, character in enumerate(text):
        if not (character == "\n" and index and text[index - 1] == "\r"):
            offsets.append(index)
    offsets.append(len(text))

    def moved(part: dict[str, Any]) -> dict[str, Any]:
        return {**part, "start": offsets[part["start"]], "end": offsets[part["end"]]}

    repairs = [{**fix, "edits": [moved(edit) for edit in fix["edits"]]} for fix in problem["fixes"]]
    return {**moved(problem), "fixes": repairs}


def _replacing(token: Token, names: Iterable[str]) -> list[dict[str, Any]]:
    """Return a fix for each of the names that may replace a token."""
    return [_fix(f"Replace by `{name}`", token.start, token.end, name) for name in names]


def _fixes_of(text: str, token: Token, outlined: Outline, declared: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return fixes for the first unexpected token of a query; `declared` contains the prefixes of the store."""
    if token.kind is Kind.WORD:
        return _replacing(token, similar_keywords(token.text))
    prefix, _, local = token.text.partition(":")
    if token.kind is not Kind.NAME or prefix in outlined.prefixes or prefix in PREFIXES:
        return []
    near = similar(f"{prefix}:", [f"{one}:" for one in (*outlined.prefixes, *PREFIXES)])
    fixes = _replacing(token, [name + local for name in near])
    namespace = declared.get(prefix) or WELL_KNOWN.get(prefix)
    if namespace:
        at, line = declaration(text, {prefix: namespace})
        fixes.insert(0, _fix(f"Declare `{prefix}:` as <{namespace}>", at, at, line))
    return fixes


def _closing(text: str, outlined: Outline) -> list[dict[str, Any]]:
    """Return a fix that closes the open brackets at the end of a query."""
    missing = " ".join(frame.closes for frame in reversed(outlined.frames) if frame.closes)
    end = len(text.rstrip())
    return [_fix(f"Add `{missing}`", end, end, f" {missing}")] if missing else []


def _fix(title: str, start: int, end: int, text: str) -> dict[str, Any]:
    return {"title": title, "edits": [{"start": start, "end": end, "text": text}]}
