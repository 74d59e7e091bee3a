"""Unbound variables and unjoined patterns, from the outline of a valid query."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.query.completion.outline import Outline, Pattern, Slot, Use

if TYPE_CHECKING:
    from collections.abc import Iterator


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
