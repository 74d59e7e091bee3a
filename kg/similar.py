"""Suggestions for misspelt names."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher, get_close_matches
from heapq import nlargest

from kg.errors import UnknownNameError

__all__ = ["did_you_mean", "folded", "misspelt", "similar", "suggest", "unknown"]

_FEW = 3
_ALIKE = 0.6
_ALMOST = 0.7
_MANY = 1000
"""Up to this number, all names are compared letter by letter."""
_PIECE = 3
"""Number of letters in a piece."""


def folded(name: str) -> str:
    """Return the letters and digits of a name in lower case, for comparisons that ignore the spelling."""
    return "".join(sign for sign in name.casefold() if sign.isalnum())


def similar(name: str, known: Iterable[str], limit: int = _FEW) -> list[str]:
    """Return up to `limit` of the `known` names as suggestions for `name`, the likeliest first.

    A name also matches by a part of it (`move` for `move_base`) or without its package (`base` for `nav/base`).
    """
    wanted = name.strip().lower()
    names = {candidate.lower(): candidate for candidate in sorted(set(known), reverse=True) if candidate}
    if len(names) > _MANY:
        names = {candidate: names[candidate] for candidate in _nearest(wanted, names)}
    close = get_close_matches(wanted, names, n=limit, cutoff=_ALIKE)
    last = wanted.rpartition("/")[2]
    parts = [candidate for candidate in names if last and (last in candidate or candidate in wanted)]
    parts.sort(key=lambda candidate: (-SequenceMatcher(None, wanted, candidate).ratio(), candidate))
    return [names[candidate] for candidate in dict.fromkeys([*close, *parts])][:limit]


def _nearest(wanted: str, names: Iterable[str]) -> list[str]:
    """Return the names that share the most pieces with `wanted`, in their order.

    This is a fast filter before names are compared letter by letter.
    """
    pieces = {wanted[at : at + _PIECE] for at in range(max(len(wanted) - _PIECE + 1, 1))}
    ranks = {name: sum(piece in name for piece in pieces) / (len(wanted) + len(name)) for name in names}
    kept = set(nlargest(_MANY, ranks, key=ranks.__getitem__))
    return [name for name in ranks if name in kept]


def misspelt(name: str, known: Iterable[str]) -> list[str]:
    """Return the `known` names that `name` may be a misspelling of, the likeliest first.

    Unlike `similar`, this returns no longer names with the same part, and none that differ only in their digits.
    """
    wanted = name.lower()
    others = {other.lower(): other for other in known if _letters(other) != _letters(name) or other.lower() == wanted}
    return [others[other] for other in get_close_matches(wanted, others, n=_FEW, cutoff=_ALMOST)]


def _letters(name: str) -> str:
    return "".join(sign for sign in name.lower() if not sign.isdigit())


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """Return a "did you mean" question for an error about an unknown `name`; None if no name is similar."""
    return suggest(similar(name, known))


def suggest(names: Iterable[str]) -> str | None:
    """Return a "did you mean" question for suggested names, in their order; None if there are none."""
    found = [f"`{name}`" for name in names]
    if not found:
        return None
    *others, last = found
    return f"Did you mean {', '.join(others)} or {last}?" if others else f"Did you mean {last}?"


def unknown(kind: str, name: str, names: Iterable[str], *, otherwise: str) -> UnknownNameError:
    """Return the error KG001 about a name: with suggestions from `names`, else with the hint `otherwise`."""
    hint = did_you_mean(name, names) or otherwise
    return UnknownNameError("KG001", f"unknown {kind} `{name}`", hint=hint)
