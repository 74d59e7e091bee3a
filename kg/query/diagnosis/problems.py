"""`diagnose`: the problems of a query and edits that fix them, the same for all interfaces."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Final

import pyoxigraph

from kg.errors import QueryError
from kg.query.completion.outline import Outline, Pattern, Slot, Use, outline
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


_PATTERN: Final = frozenset({Slot.SUBJECT, Slot.PREDICATE, Slot.OBJECT, Slot.AFTER, Slot.GRAPH, Slot.OPENING})


def bound(outline: Outline) -> set[str]:
    """Return the names of the variables bound by a pattern, BIND, VALUES or AS."""
    binding = {Slot.NEW, Slot.COLUMNS}
    return {use.name for use in outline.uses if use.slot in binding or (use.group > 0 and use.slot in _PATTERN)}


def unbound(outline: Outline) -> Iterator[Use]:
    """Yield the first use of each variable that is selected or computed with, but never bound."""
    seen = bound(outline)
    for use in outline.uses:
        if use.name not in seen:
            seen.add(use.name)
            yield use


def product(outline: Outline) -> Pattern | None:
    """Return the first pattern that shares no variable with those before it, even indirectly; None if all are joined.

    Queries with UNION are skipped. The variables of a nested group count as joined.
    """
    if "union" in outline.words:
        return None
    for group, around in outline.inside.items():
        if group and not around:
            pattern = _second_part(outline, group)
            if pattern is not None:
                return pattern
    return None


def _second_part(outline: Outline, group: int) -> Pattern | None:
    parts: list[set[str]] = []
    patterns = [(each, _names(each)) for each in outline.patterns if each.group == group]
    for together in (*(names for _, names in patterns), *_joined(outline, group)):
        touching = [part for part in parts if part & together]
        parts = [part for part in parts if not part & together]
        parts.append(together.union(*touching))
    first = next((names for _, names in patterns if names), set())
    own = next((part for part in parts if part & first), set())
    return next((each for each, names in patterns if names and not names & own), None)


def _names(pattern: Pattern) -> set[str]:
    return {term for term in (pattern.subject, pattern.object) if term.startswith(("?", "_:"))}


def _joined(outline: Outline, group: int) -> Iterator[set[str]]:
    """Yield the sets of variables that occur together in an expression or a nested group."""
    by_expression: dict[int, set[str]] = {}
    by_group: dict[int, set[str]] = {}
    for use in outline.uses:
        if use.within:
            by_expression.setdefault(use.within, set()).add("?" + use.name)
        inner = _child_of(outline, use.group, group)
        if inner:
            by_group.setdefault(inner, set()).add("?" + use.name)
    yield from by_expression.values()
    yield from by_group.values()


def _child_of(outline: Outline, number: int, group: int) -> int:
    """Return the group directly in `group` that is or contains `number`; 0 if there is none."""
    while number and outline.inside.get(number, 0) != group:
        number = outline.inside.get(number, 0)
    return number
