"""Names that were meant, for names typed almost right."""

from __future__ import annotations

from difflib import SequenceMatcher, get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["asked", "did_you_mean", "similar"]

_FEW = 3
_ALIKE = 0.6


def similar(name: str, known: Iterable[str], limit: int = _FEW) -> list[str]:
    """Return up to `limit` of the `known` names that `name` may stand for, the likeliest first.

    A name is also meant by a part of it (`move` for `move_base`) or without its package (`base` for `nav/base`).
    """
    wanted = name.strip().lower()
    names = {candidate.lower(): candidate for candidate in sorted(set(known), reverse=True)}
    close = get_close_matches(wanted, names, n=limit, cutoff=_ALIKE)
    last = wanted.rpartition("/")[2]
    parts = [candidate for candidate in names if last and (last in candidate or candidate in wanted)]
    parts.sort(key=lambda candidate: (-SequenceMatcher(None, wanted, candidate).ratio(), candidate))
    return [names[candidate] for candidate in dict.fromkeys([*close, *parts])][:limit]


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """Return the question to put behind an error about an unknown `name`; None when nothing is alike."""
    return asked(similar(name, known))


def asked(names: Iterable[str]) -> str | None:
    """Return the question whether one of some names was meant, in their order; None when there are none."""
    found = [f"`{name}`" for name in names]
    if not found:
        return None
    *others, last = found
    return f"Did you mean {', '.join(others)} or {last}?" if others else f"Did you mean {last}?"
