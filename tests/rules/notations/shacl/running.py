"""Runs SHACL rules over data in Turtle."""

from __future__ import annotations

from pyoxigraph import CanonicalizationAlgorithm, Dataset, Quad, RdfFormat, Triple, parse
from rules.engine.comparing import inferred

from kg.rules.engine.limits import Limits
from kg.rules.form import AUXILIARY
from kg.rules.notations.shacl import rules
from kg.rules.specialise import specialise

__all__ = ["canonical", "evaluated", "triples"]

LIMIT = Limits(max_triples=10_000)
"""Allow rules that create terms from types: only the data shows whether a class is below another."""


def triples(text: str) -> list[Triple]:
    """Return the triples of a Turtle text."""
    return [quad.triple for quad in parse(text.encode(), RdfFormat.TURTLE)]


def evaluated(shapes: str, data: list[Triple], *, cut: bool = False) -> list[Triple]:
    """Return the inferences of the rules of a shapes graph from data; `cut`: with rules specialised to its schema."""
    facts = [(triple.subject, triple.predicate, triple.object) for triple in data]
    compiled = rules(shapes, "tests/case", "rules.ttl")
    found = inferred(specialise(compiled, data) if cut else compiled, facts, LIMIT)
    lines = (f"{subject} {predicate} {value} .\n" for subject, predicate, value in found)
    return triples("".join(line for line in lines if f"<{AUXILIARY}" not in line))


def canonical(found: list[Triple]) -> set[str]:
    """Return triples in N-Triples with canonical blank nodes."""
    dataset = Dataset(Quad(triple.subject, triple.predicate, triple.object) for triple in found)
    dataset.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return {str(quad.triple) for quad in dataset}
