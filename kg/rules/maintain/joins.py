"""Whether a small change can give a rule any solution, decided from the text of the rule before it is planned.

Most rules that a small change reaches have no solution with it: another atom of the body finds no triple for the terms
that changed. Planning such a rule costs more than this check.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from pyoxigraph import NamedNode

from kg.rules.engine.facts import unpack
from kg.rules.form import TripleTerm, Variable
from kg.rules.maintain.patterns import ANY

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.rules.engine.facts import Facts
    from kg.rules.engine.terms import Dictionary
    from kg.rules.form import Atom, Pattern
    from kg.rules.maintain.worlds import Delta, World

__all__ = ["Join"]

_FEW: Final = 32
"""Larger changes are not checked triple by triple."""


class _Atom(NamedTuple):
    """An atom with a constant predicate: identifiers of terms, names of variables, None for a triple term."""

    subject: int | str | None
    predicate: int
    object: int | str | None


class Join:
    """The atoms of the outer body of a rule; `inner` are the patterns that the rest of its body reads."""

    def __init__(self, atoms: Sequence[Atom], inner: frozenset[int], dictionary: Dictionary) -> None:
        self._dictionary = dictionary
        constant = [one for one in atoms if isinstance(one.predicate, NamedNode)]
        self._inner = inner if len(constant) == len(atoms) else inner | {ANY}
        self._atoms = [
            _Atom(self._node(one.subject), dictionary.intern_term(one.predicate), self._node(one.object))
            for one in constant
            if isinstance(one.predicate, NamedNode)
        ]

    def _node(self, node: Pattern) -> int | str | None:
        if isinstance(node, Variable):
            return node.name
        return None if isinstance(node, TripleTerm) else self._dictionary.intern_term(node)

    def possible(self, changes: Sequence[Delta], worlds: tuple[World, World]) -> bool:
        """Tell whether a solution, in the world before or after, may have a triple of the changes; True if unknown."""
        if any(not self._inner.isdisjoint(change.patterns) for change in changes):
            return True
        parts = [part for change in changes for part in (change.known, change.asserted)]
        if sum(map(len, parts)) > _FEW:
            return True
        known = [world.known for world in worlds]
        return any(
            self._joined(atom, subject, value, known)
            for part in parts
            for atom in self._atoms
            for subject, value in zip(*(side.tolist() for side in unpack(part.keys(atom.predicate))), strict=True)
        )

    def _joined(self, atom: _Atom, subject: int, value: int, known: Iterable[Facts]) -> bool:
        """Tell whether each other atom has triples where `atom` matches one triple."""
        bound: dict[int | str, int] = {}
        for node, term in ((atom.subject, subject), (atom.object, value)):
            if node is not None and (node if isinstance(node, int) else bound.setdefault(node, term)) != term:
                return False
        return all(
            any(one.has(other.predicate, _term(other.subject, bound), _term(other.object, bound)) for one in known)
            for other in self._atoms
            if other is not atom
        )


def _term(node: int | str | None, bound: dict[int | str, int]) -> int | None:
    """Return the term that a node of an atom has, None for any."""
    return node if isinstance(node, int) or node is None else bound.get(node)
