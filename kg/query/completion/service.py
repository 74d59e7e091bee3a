"""`complete`: what may stand at a position of a query, for any face."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.query.completion.candidates import candidates
from kg.query.completion.matching import WORST, matcher
from kg.query.completion.site import site_of
from kg.query.completion.typed import Form, typed
from kg.syntax.prologue import declaration

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from kg.query.completion.keeping import Kept
    from kg.query.completion.site import Candidate, Site
    from kg.query.stored import StoredQuery

__all__ = ["complete"]

_MOST: Final = 100
"""How many candidates are offered at most."""


def complete(
    text: str, position: int, kept: Kept, stored: Callable[[], Sequence[StoredQuery]] = tuple, *, fresh: bool = False
) -> dict[str, Any]:
    """Return what may stand at `position` (in code points) of the query `text`, the likeliest first.

    `range` (`start`, `end`) is the part of the text that an item replaces. Each of the `items` has `label`, `insert`,
    `kind` (keyword, function, variable, prefix, class, property, value, graph or query), `detail`, `count` (null where
    nothing is counted), `documentation`, `holes` (offsets in `insert` that want to be filled, in the order of the Tab
    key) and `edits`: what else is to be changed, each with `start`, `end` and `text`, in offsets of the text as it is.
    `more` tells that there were more. `ready` is false while the store is still being counted. `stored` returns the
    stored queries.
    """
    at = typed(text, position)
    statistics = kept.statistics(fresh=fresh)
    site = site_of(text, at, kept, statistics, stored)
    found = _best(site, candidates(site))
    return {
        "range": {"start": at.start, "end": at.end},
        "items": [_item(site, one) for one in found[:_MOST]],
        "more": len(found) > _MOST,
        "ready": bool(statistics.properties),
    }


def _best(site: Site, found: Iterable[Candidate]) -> list[Candidate]:
    """Return the candidates that fit what was typed, the best first; of those that insert the same only one."""
    fit = _fit(site)
    ranked = []
    for one in found:
        score = fit(one)
        if score is not None:
            ranked.append(((score + 2 * one.rank, one.rank, -(one.count or 0), one.label), one))
    ranked.sort(key=lambda pair: pair[0])
    best: dict[str, Candidate] = {}
    for _, one in ranked:
        best.setdefault(one.insert, one)
    return list(best.values())


def _fit(site: Site) -> Callable[[Candidate], int | None]:
    text, form = site.typed.text, site.typed.form
    if form is Form.VARIABLE:
        variable = matcher(text[1:])
        return lambda one: variable(one.key[1:]) if one.kind == "variable" else None
    if form is Form.NAME:
        prefix, _, local = text.partition(":")
        name = matcher(local)
        return lambda one: _of_name(one, prefix, name)
    whole = matcher(text.removeprefix("<"))
    if form is not Form.WORD:
        return lambda one: whole(one.key)
    return lambda one: _of_word(one, text, whole)


def _of_name(one: Candidate, prefix: str, name: Callable[[str], int | None]) -> int | None:
    """Return how a candidate fits a prefixed name: its prefix must be the same."""
    own, colon, local = one.insert.partition(":")
    return name(local.partition(" ")[0]) if colon and own == prefix else None


def _of_word(one: Candidate, text: str, whole: Callable[[str], int | None]) -> int | None:
    """Return how a candidate fits a word: a name also by what stands behind its prefix, a variable without its mark."""
    score = whole(one.key)
    if one.kind in {"class", "property", "value"} and ":" in one.label:
        local = whole(one.label.partition(":")[2])
        score = min((each for each in (score, local) if each is not None), default=None)
    elif one.kind == "variable":
        score = whole(one.key[1:])
    if score == WORST and one.kind in {"keyword", "function"} and len(text) < _WORD:
        return None
    return score


_WORD: Final = 3
"""Shorter words mean no keyword that they are only spread over."""


def _item(site: Site, one: Candidate) -> dict[str, Any]:
    return {
        "label": one.label,
        "insert": one.insert,
        "kind": one.kind,
        "detail": one.detail,
        "count": one.count,
        "documentation": one.documentation,
        "holes": list(one.holes),
        "edits": _edits(site, one),
    }


def _edits(site: Site, one: Candidate) -> list[dict[str, Any]]:
    """Return the declaration of the prefix of what is inserted, where the query lacks it."""
    if not one.prefix or one.prefix in site.whole.prefixes or one.prefix not in site.prefixes:
        return []
    at, text = declaration(site.text, {one.prefix: site.prefixes[one.prefix]})
    return [{"start": at, "end": at, "text": text}]
