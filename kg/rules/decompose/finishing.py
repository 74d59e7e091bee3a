"""The last steps to a rule: names that fit their place, heads that fit their part."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules import sparql
from kg.rules.decompose.parts import IndivisibleError
from kg.rules.decompose.renaming import everywhere, renamed, renamed_atom
from kg.rules.form import Aggregate, Assignment, Atom, EngineBlock, Exists, Filter, Variable
from kg.rules.scope import binds, bound_in, mentions

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.rules.decompose.names import Names
    from kg.rules.form import Element

__all__ = ["finished"]

Statement = tuple[tuple[Atom, ...], tuple["Element", ...]]
"""A head and a body."""


def finished(head: tuple[Atom, ...], body: tuple[Element, ...], names: Names) -> Statement | None:
    """Return a rule's head and body as they stay; None if nothing comes of the part.

    IndivisibleError where a block may leave a variable unbound that another element mentions.
    """
    body = _printable(body, names)
    head, body = _without_copies(head, body)
    _check_blocks(body)
    bound = bound_in(body)
    kept = tuple(atom for atom in head if binds(atom) <= bound)
    return (kept, body) if kept else None


def _expressions(body: Sequence[Element]) -> Iterator[str]:
    """Yield the names in expressions and blocks at any depth, as they are spelt there."""
    for element in body:
        if isinstance(element, Filter | Assignment):
            yield from element.expression.variables
        elif isinstance(element, EngineBlock):
            yield from (sparql.spelling(variable)[1:] for variable in element.variables)
        elif isinstance(element, Exists | Aggregate):
            yield from _expressions(element.body)


def _printable(body: tuple[Element, ...], names: Names) -> tuple[Element, ...]:
    """Give SPARQL names to variables of blank nodes that are used in expressions or blocks."""
    written = set(_expressions(body))
    hidden = {variable for variable in everywhere(body) if variable.name.startswith(".")}
    chosen = sorted((v for v in hidden if sparql.spelling(v)[1:] in written), key=str)
    return renamed(body, {variable: names.like(variable) for variable in chosen})


def _without_copies(head: tuple[Atom, ...], body: tuple[Element, ...]) -> Statement:
    """Use a variable in the place of one that is assigned its value: a solution has the same term for both."""
    index = 0
    while index < len(body):
        element = body[index]
        source = _copied(element, body[index + 1 :])
        if source is None or not isinstance(element, Assignment):
            index += 1
            continue
        names = {element.variable: source}
        head = tuple(renamed_atom(atom, names) for atom in head)
        # Only where the variable is meant: text may have another of that name inside.
        rest = (renamed([e], names)[0] if element.variable in mentions(e) else e for e in body[index + 1 :])
        body = (*body[:index], *rest)
    return head, body


def _copied(element: Element, rest: tuple[Element, ...]) -> Variable | None:
    """Return the variable whose value an element assigns to another that may be replaced in the `rest`."""
    if not isinstance(element, Assignment) or element.expression.text != f"?{''.join(element.expression.variables)}":
        return None
    simple = all(isinstance(other, Atom | Filter | Assignment) for other in rest if element.variable in mentions(other))
    return Variable(element.expression.variables[0]) if simple else None


def _check_blocks(body: tuple[Element, ...]) -> None:
    for index, element in enumerate(body):
        if isinstance(element, Exists | Aggregate):
            _check_blocks(element.body)
        inner = element.body if isinstance(element, Exists) else (element,)
        open_ends = {variable for one in inner if isinstance(one, EngineBlock) for variable in one.optional}
        if open_ends and not open_ends.isdisjoint(_mentioned((*body[:index], *body[index + 1 :]))):
            raise IndivisibleError


def _mentioned(body: Iterable[Element]) -> frozenset[Variable]:
    return frozenset().union(*map(mentions, body))
