"""Terms with variables: what stands in a position of a triple pattern. Terms without are pyoxigraph's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from pyoxigraph import BlankNode, Triple

from kg.store.terms import Term

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

__all__ = ["Pattern", "Term", "TripleTerm", "Variable", "has_blank", "replaced", "variables_of"]


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable, its name without `?`. Names that begin with `.` were made by decomposition or stand for `[]`."""

    name: str

    def __hash__(self) -> int:
        # That of a dataclass makes a tuple first, and sets of variables are made all the time.
        return hash(self.name)

    def __str__(self) -> str:
        return f"?{self.name}"


@dataclass(frozen=True, slots=True)
class TripleTerm:
    """A triple term (RDF 1.2) with variables in it: `<<( ?s ?p ?o )>>`."""

    subject: Pattern
    predicate: Pattern
    object: Pattern

    def __iter__(self) -> Iterator[Pattern]:
        """Yield subject, predicate and object, as a triple of pyoxigraph does."""
        return iter((self.subject, self.predicate, self.object))


Pattern: TypeAlias = Term | Variable | TripleTerm
"""What may stand in a position of an atom. A blank node in a body is a constant (a term of the data): those that a
notation writes as variables have become variables. A blank node in a head stands for a new one in each solution."""


def variables_of(pattern: Pattern) -> Iterator[Variable]:
    """Yield the variables in a position of an atom, from left to right."""
    if isinstance(pattern, Variable):
        yield pattern
    elif isinstance(pattern, TripleTerm):
        for inner in pattern:
            yield from variables_of(inner)


def replaced(pattern: Pattern, by: Mapping[Variable, Pattern]) -> Pattern:
    """Return a pattern with other patterns in the place of some variables."""
    if isinstance(pattern, Variable):
        return by.get(pattern, pattern)
    return TripleTerm(*(replaced(inner, by) for inner in pattern)) if isinstance(pattern, TripleTerm) else pattern


def has_blank(pattern: Pattern) -> bool:
    """Return whether a pattern is a blank node or has one in it."""
    return any(map(has_blank, pattern)) if isinstance(pattern, Triple | TripleTerm) else isinstance(pattern, BlankNode)
