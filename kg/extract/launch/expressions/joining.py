"""`left + right`: texts with unknown parts, and lists with items that are not known, are joined part by part."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.launch.expressions.texts import simplify, to_text
from kg.extract.launch.expressions.values import Choice, Items, Unknown, Words, guard
from kg.extract.launch.expressions.whole import MAX_ITEMS, MAX_TEXT, refuse_over

if TYPE_CHECKING:
    from kg.extract.launch.expressions.values import Value

__all__ = ["add", "concatenate"]


def concatenate(left: Value, right: Value) -> Value:
    """Return the text of two texts, of which parts need not be known; `Unknown` for what is no text."""
    joined = add(left, right)
    return joined if joined is not None else Unknown("a text is made of what is no text")


def add(left: Value, right: Value) -> Value:
    """Return `left + right` of texts or lists; None for all else."""
    if isinstance(left, str) and isinstance(right, str):
        refuse_over(len(left) + len(right), MAX_TEXT)
        return left + right
    if isinstance(left, Items) and isinstance(right, Items):
        refuse_over(len(left) + len(right), MAX_ITEMS)
        return Items([*left, *right], left.guards, left.places + right.places)
    if isinstance(left, tuple) and isinstance(right, tuple):
        refuse_over(len(left) + len(right), MAX_ITEMS)
        return left + right
    if isinstance(left, str | Words) and isinstance(right, str | Words | Unknown | Choice):
        return simplify(to_text(left) + to_text(right), lazy=isinstance(left, Words) and left.lazy)
    if isinstance(left, Unknown | Choice) and isinstance(right, str | Words):
        return simplify(to_text(left) + to_text(right))
    if isinstance(left, Items | Choice | Unknown) and isinstance(right, Items | Choice | Unknown):
        return Items([*_spread(left), *_spread(right)], left.guards if isinstance(left, Items) else ())
    return None


def _spread(value: Items | Choice | Unknown) -> list[Value]:
    """Return the items of a list of which not all need to be known."""
    if isinstance(value, Items):
        return list(value)
    if isinstance(value, Unknown):
        return [value]
    found: list[Value] = []
    for condition, option in value.options:
        inner = list(option) if isinstance(option, Items | tuple) else [option]
        found += [guard(condition, item) if condition else item for item in inner]
    return found
