"""Runs a rule set of SPARQL 1.2 RL on a graph, for the W3C's tests and for our own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import CanonicalizationAlgorithm, Dataset, Quad, RdfFormat, Store, Triple, parse
from rules.engine.comparing import inferred

from kg.errors import Place
from kg.rules.form import Atom, Rule
from kg.rules.reading import read

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from kg.rules.files import RuleFile

__all__ = ["canonical", "infer", "load", "rules_of"]


def load(path: Path) -> list[Triple]:
    """Return the triples of a Turtle file."""
    text = path.read_text(encoding="utf-8")
    return [quad.triple for quad in parse(text, format=RdfFormat.TURTLE, base_iri=path.absolute().as_uri())]


def rules_of(file: RuleFile) -> tuple[Rule, ...]:
    """Return the rules of a file and an equivalent rule without a body for its stated triples."""
    stated = tuple(Atom(triple.subject, triple.predicate, triple.object) for triple in file.data)
    return (*file.rules, Rule(f"{file.name}/data", stated, (), Place(str(file.path)))) if stated else file.rules


def infer(rules: Path, data: Iterable[Triple]) -> list[Triple]:
    """Return the inferences of a rule set from some triples, without these."""
    facts = [(triple.subject, triple.predicate, triple.object) for triple in data]
    found = inferred(rules_of(read(rules, rules.stem)), facts)
    return [Triple(*fact) for fact in found]  # type: ignore[arg-type]  # what is inferred is triples


def canonical(triples: Iterable[Triple]) -> set[str]:
    """Return triples as text in a store's spelling, equal for graphs that differ only in blank node labels."""
    store = Store()
    store.extend(Quad(triple.subject, triple.predicate, triple.object) for triple in triples)
    dataset = Dataset(store)
    dataset.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return {str(quad.triple) for quad in dataset}
