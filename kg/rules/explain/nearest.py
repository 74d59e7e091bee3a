"""The nearest matches of a missing fact, by similarity of names."""

from __future__ import annotations

from difflib import SequenceMatcher
from typing import TYPE_CHECKING, Final

from kg.rules.form import Variable
from kg.similar import similar

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from pyoxigraph import Triple

    from kg.rules.explain.view import View
    from kg.rules.form import Atom, Pattern, Term

__all__ = ["filled", "instead", "nearest"]

_FEW: Final = 3
_CANDIDATES: Final = 500
_NO_VALUE: Final = 0.1
_ALIKE: Final = 0.4
"""Names less alike than this are not worth mentioning."""


def filled(pattern: Pattern, solution: Mapping[str, Term]) -> Term | None:
    """Return the term at a position of an atom under a solution; None if it is free."""
    if isinstance(pattern, Variable):
        return solution.get(pattern.name)
    return None if hasattr(pattern, "subject") else pattern


def nearest(view: View, atom: Atom, solutions: Sequence[dict[str, Term]]) -> tuple[dict[str, Term], tuple[str, ...]]:
    """Return the solution under which `atom` comes closest to something that is there, and sentences about that."""
    ranked = [
        (score, text, solution)
        for solution in solutions
        for score, text in _alternatives(view, *(filled(position, solution) for position in atom.positions))
    ]
    ranked.sort(key=lambda each: -each[0])
    if not ranked:
        return solutions[0], ()
    return ranked[0][2], tuple(dict.fromkeys(text for _, text, _ in ranked))[:_FEW]


def _alternatives(
    view: View, subject: Term | None, predicate: Term | None, value: Term | None
) -> Iterator[tuple[float, str]]:
    """Yield existing alternatives to a missing triple, with their similarity (1: the same)."""
    if predicate is None:
        return
    name = view.spelt(predicate)
    if subject is not None:
        objects = view.objects(subject, predicate, _CANDIDATES)
        for other in objects:
            yield (
                _likeness(view, value, other),
                f"{view.label(subject)} has {view.spelt(predicate)} {view.label(other)}",
            )
        if not objects:
            yield _NO_VALUE, f"{view.label(subject)} has no {name}"
    if value is not None:
        for other in view.subjects(predicate, value, _CANDIDATES):
            yield (
                _likeness(view, subject, other),
                f"{view.label(other)} has {name} {view.label(value)}",
            )


def _likeness(view: View, wanted: Term | None, other: Term) -> float:
    """Compare the labels of both, and the last parts of their names; return the higher similarity."""
    if wanted is None:
        return 1.0
    pairs = ((view.label(wanted), view.label(other)), (_last(wanted), _last(other)))
    return max(SequenceMatcher(None, *pair).ratio() for pair in pairs)


def _last(term: Term) -> str:
    text = str(term).rstrip(">/#")
    return text[max(text.rfind("/"), text.rfind("#")) + 1 :]


def instead(view: View, fact: Triple) -> tuple[str, ...]:
    """Return sentences about what the store has instead of a fact: other values, a property of a similar name."""
    if view.graphs(fact):
        return ("the store holds it: `kg why` explains it",)
    properties = {view.spelt(each) for each in view.predicates(fact.subject, _CANDIDATES)}
    if not properties:
        return (f"the store says nothing about {view.spelt(fact.subject)}",)
    ranked = sorted(_alternatives(view, fact.subject, fact.predicate, fact.object), key=lambda each: -each[0])
    texts = [text for score, text in ranked[:_FEW] if score > _ALIKE]
    wanted = view.spelt(fact.predicate)
    if wanted not in properties:
        texts += [f"did you mean {name}?" for name in similar(wanted, properties, 1)]
    return tuple(dict.fromkeys(texts))
