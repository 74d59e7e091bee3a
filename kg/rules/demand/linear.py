"""Recursions that a demand for one end follows without answering every node on its way (Naughton et al. 1989).

    right   p(x, z) from  S(x, y), p(y, z)        composes what S relates before p
    left    p(x, z) from  p(x, y), S(y, z)        after it
    double  p(x, z) from  p(x, y), p(y, z)
    exit    any rule of p that does not recur

With demand for the subject, plain magic sets turn the right form into demand for every y that x reaches, so that all
pairs along a chain are derived where one end was asked for. Here the nodes reached are carried with x instead, and a
double rule becomes a left one: p(x, z) from p(x, y), exit(y, z). With demand for the object it is the other way round.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.rules.form import AUXILIARY, Atom, Variable, variables_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.rules.form import Element, Rule

_DOUBLE: Final = 2
"""How many atoms a double rule has."""


@dataclass(frozen=True, slots=True)
class Step:
    """A rule of the left or the right form: its head, the atom of the same predicate, and the atoms next to it."""

    rule: Rule
    head: Atom
    recursive: Atom
    beside: tuple[Atom, ...]


@dataclass(frozen=True, slots=True)
class Recursion:
    """The rules of a predicate, where each has one of the forms above; a double rule goes with exits alone."""

    predicate: NamedNode
    exits: tuple[tuple[Rule, Atom], ...]
    right: tuple[Step, ...]
    left: tuple[Step, ...]
    double: bool


def exit_of(predicate: NamedNode) -> NamedNode:
    """Return the predicate of the stored triples of a predicate and of the triples of its exits."""
    return NamedNode(f"{AUXILIARY}exit/{predicate.value}")


def stored_of(predicate: NamedNode) -> NamedNode:
    """Return the predicate of the stored triples of a predicate."""
    return NamedNode(f"{AUXILIARY}stored/{predicate.value}")


def via_of(predicate: NamedNode, adornment: str) -> NamedNode:
    """Return the predicate that relates an end asked for to the nodes that its steps reach."""
    return NamedNode(f"{AUXILIARY}via/{adornment}/{predicate.value}")


def recursion_of(
    predicate: NamedNode, rules: Sequence[Rule], recurs: Callable[[Sequence[Element]], bool]
) -> Recursion | None:
    """Return the rules of a predicate by their forms; None where one has another form, or none is recursive.

    `recurs` returns whether elements of a body read, directly or through other rules, what `rules` derive.
    """
    exits: list[tuple[Rule, Atom]] = []
    right: list[Step] = []
    left: list[Step] = []
    double = False
    for rule in rules:
        for head in (head for head in rule.head if head.predicate == predicate):
            if not recurs(rule.body):
                exits.append((rule, head))
            elif _is_double(head, rule.body):
                double = True
            elif (step := _step(rule, head, recurs)) is None:
                return None
            elif step.recursive.object == head.object:
                right.append(step)
            else:
                left.append(step)
    if double == bool(right or left):
        return None
    return Recursion(predicate, tuple(exits), tuple(right), tuple(left), double)


def _is_double(head: Atom, body: Sequence[Element]) -> bool:
    if len(body) != _DOUBLE:
        return False
    first, second = body
    if not (isinstance(first, Atom) and isinstance(second, Atom)) or first.asserted or second.asserted:
        return False
    if first.predicate != head.predicate or second.predicate != head.predicate:
        return False
    ends = {first.subject, first.object, second.object}
    chained = first.object == second.subject and (first.subject, second.object) == (head.subject, head.object)
    return chained and len(ends) == _DOUBLE + 1 and all(isinstance(end, Variable) for end in ends)


def _step(rule: Rule, head: Atom, recurs: Callable[[Sequence[Element]], bool]) -> Step | None:
    """Return a rule as one of the left or the right form."""
    atoms = [element for element in rule.body if isinstance(element, Atom)]
    recursive = [atom for atom in atoms if atom.predicate == head.predicate and not atom.asserted]
    if len(atoms) < len(rule.body) or len(recursive) != 1:
        return None
    (atom,) = recursive
    beside = tuple(other for other in atoms if other is not atom)
    if recurs(beside):
        return None
    if atom.object == head.object:
        kept, others = head.object, (head.subject, atom.subject)
    elif atom.subject == head.subject:
        kept, others = head.subject, (head.object, atom.object)
    else:
        return None
    used = {variable for other in beside for position in other.positions for variable in variables_of(position)}
    moved = {end for end in others if isinstance(end, Variable)}
    if not isinstance(kept, Variable) or kept in used or kept in moved or not moved <= used:
        return None
    # What is carried becomes a subject, which a literal cannot be.
    if kept == head.subject and atom.object not in {other.subject for other in beside}:
        return None
    return Step(rule, head, atom, beside)
