"""Whether a small change can give a rule any solution, decided from the text of the rule before it is planned.

Most rules that a small change reaches have no solution with it: another atom of the body finds no triple for the terms
that changed. Planning such a rule costs more than this check.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from pyoxigraph import NamedNode

from kg.rules.form import Atom, Exists, TripleTerm, Variable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from kg.rules.engine.facts import Facts
    from kg.rules.engine.terms import Dictionary
    from kg.rules.form import Element, Pattern
    from kg.rules.maintain.worlds import Delta, World

_FEW: Final = 32
"""Larger changes are not checked triple by triple."""


class _Atom(NamedTuple):
    """An atom with a constant predicate: identifiers of terms, names of variables, None for a triple term."""

    subject: int | str | None
    predicate: int
    object: int | str | None


class Join:
    """The atoms of the outer body of a rule, and those of EXISTS and NOT EXISTS directly in it.

    `patterns` returns the patterns that an element reads. A change of what any other element reads is not checked.
    """

    def __init__(
        self, body: Sequence[Element], patterns: Callable[[Element], Iterable[int]], dictionary: Dictionary
    ) -> None:
        self._dictionary = dictionary
        self._outer: list[_Atom] = []
        self._places: list[tuple[_Atom, frozenset[str] | None]] = []
        """Atoms that may read a changed triple, with the outer variables in scope; None for atoms of the outer body."""
        self._others: set[int] = set()
        for element in body:
            if isinstance(element, Exists):
                # Variables that the outer body binds later are others.
                scope = frozenset(node for atom in self._outer for node in atom if isinstance(node, str))
                for inner in element.body:
                    if (atom := self._atom(inner)) is not None:
                        self._places.append((atom, scope))
                    else:
                        self._others.update(patterns(inner))
            elif (atom := self._atom(element)) is not None:
                self._outer.append(atom)
                self._places.append((atom, None))
            else:
                self._others.update(patterns(element))

    def _atom(self, element: Element) -> _Atom | None:
        """Return an element as an atom with a constant predicate, None for any other."""
        if not isinstance(element, Atom) or not isinstance(element.predicate, NamedNode):
            return None
        predicate = self._dictionary.intern_term(element.predicate)
        return _Atom(self._node(element.subject), predicate, self._node(element.object))

    def _node(self, node: Pattern) -> int | str | None:
        if isinstance(node, Variable):
            return node.name
        return None if isinstance(node, TripleTerm) else self._dictionary.intern_term(node)

    def possible(self, changes: Sequence[Delta], worlds: tuple[World, World]) -> bool:
        """Return whether a solution, before or after, may have a triple of the changes; True if unknown."""
        if any(not self._others.isdisjoint(change.patterns) for change in changes):
            return True
        parts = [part for change in changes for part in (change.known, change.asserted)]
        if sum(map(len, parts)) > _FEW:
            return True
        triples: dict[int, set[int]] = {}
        for part in parts:
            for predicate, keys in part:
                triples.setdefault(predicate, set()).update(keys.tolist())
        known = [world.known for world in worlds]
        for atom, scope in self._places:
            for key in triples.get(atom.predicate, ()):
                if self._joined(atom, scope, divmod(key, 1 << 32), known):
                    return True
        return False

    def _joined(
        self, atom: _Atom, scope: frozenset[str] | None, triple: tuple[int, int], known: Sequence[Facts]
    ) -> bool:
        """Return whether each other atom of the outer body has triples where `atom` matches a triple."""
        bound: dict[int | str, int] = {}
        for node, term in zip((atom.subject, atom.object), triple, strict=True):
            if node is not None and (node if isinstance(node, int) else bound.setdefault(node, term)) != term:
                return False
        if scope is not None:
            bound = {name: term for name, term in bound.items() if name in scope}
        for other in self._outer:
            subject, value = _term(other.subject, bound), _term(other.object, bound)
            if other is not atom and not any(one.has(other.predicate, subject, value) for one in known):
                return False
        return True


def _term(node: int | str | None, bound: dict[int | str, int]) -> int | None:
    """Return the term that a node of an atom has, None for any."""
    return node if isinstance(node, int) or node is None else bound.get(node)
