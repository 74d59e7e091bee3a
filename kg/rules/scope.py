"""Which variables an element of a body binds, and which it mentions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    EngineBlock,
    Exists,
    Filter,
    TripleTerm,
    Values,
    Variable,
    variables_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.rules.form import Element

__all__ = ["binds", "bound_in", "mentions"]


def binds(element: Element) -> frozenset[Variable]:
    """Return the variables that are bound behind an element; those of an EngineBlock that may stay unbound too."""
    if isinstance(element, Atom):
        return _variables(element)
    if isinstance(element, Assignment):
        return frozenset((element.variable,))
    if isinstance(element, Values | EngineBlock):
        return frozenset(element.variables)
    if isinstance(element, Aggregate):
        return frozenset((*element.keys, *(column.variable for column in element.columns)))
    return frozenset()


def _variables(atom: Atom) -> frozenset[Variable]:
    """Return the variables of an atom; nearly all are in it by themselves, so only triple terms are searched."""
    positions = atom.positions
    found = [position for position in positions if isinstance(position, Variable)]
    for position in positions:
        if isinstance(position, TripleTerm):
            found += variables_of(position)
    return frozenset(found)


def bound_in(body: Iterable[Element]) -> frozenset[Variable]:
    """Return the variables that are bound behind a body."""
    return frozenset().union(*map(binds, body))


def mentions(element: Element) -> frozenset[Variable]:
    """Return all variables that an element shares with the body it is in, were they bound there.

    Those inside EXISTS count, for it sees what is before it; those inside an aggregate do not.
    """
    if isinstance(element, Filter):
        return frozenset(map(Variable, element.expression.variables))
    if isinstance(element, Assignment):
        return binds(element).union(map(Variable, element.expression.variables))
    if isinstance(element, Exists):
        return frozenset().union(*map(mentions, element.body))
    return binds(element)
