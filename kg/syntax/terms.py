"""Terms with variables, for the positions of triple patterns. Terms without are pyoxigraph's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from pyoxigraph import BlankNode, Triple

from kg.store.terms import Term

__all__ = ["GENERATED", "Pattern", "Term", "TripleTerm", "Variable", "has_blank", "replaced", "variables_of"]

GENERATED: Final = "_·"
"""What variables whose names begin with `.` begin with in SPARQL."""


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable, its name without `?`. Names starting with `.` are generated, or are those of `[]`."""

    name: str

    def __hash__(self) -> int:
        # The dataclass's own hash builds a tuple first, and sets of variables are frequent.
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
        """Yield subject, predicate and object, like a triple of pyoxigraph."""
        return iter((self.subject, self.predicate, self.object))


Pattern: TypeAlias = Term | Variable | TripleTerm
"""A position of an atom. A blank node in a body is a constant (a term of the data): blank nodes that a notation
treats as variables have been replaced. A blank node in a head is a new one in each solution.
"""


def variables_of(pattern: Pattern) -> Iterator[Variable]:
    """Yield the variables in a position of an atom, from left to right."""
    if isinstance(pattern, Variable):
        yield pattern
    elif isinstance(pattern, TripleTerm):
        for inner in pattern:
            yield from variables_of(inner)


def replaced(pattern: Pattern, by: Mapping[Variable, Pattern]) -> Pattern:
    """Return a pattern with some variables replaced by other patterns."""
    if isinstance(pattern, Variable):
        return by.get(pattern, pattern)
    return TripleTerm(*(replaced(inner, by) for inner in pattern)) if isinstance(pattern, TripleTerm) else pattern


def has_blank(pattern: Pattern) -> bool:
    """Return whether a pattern is or contains a blank node."""
    return any(map(has_blank, pattern)) if isinstance(pattern, Triple | TripleTerm) else isinstance(pattern, BlankNode)
