"""Runs the engine over triples of pyoxigraph's terms, for comparison with the oracle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.facts import Facts, distinct, unpack
from kg.rules.engine.terms import Dictionary

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rules.engine.oracle import Fact

    from kg.rules.engine.limits import Limits
    from kg.rules.form import Rule, Term

__all__ = ["columns", "inferred", "tuples"]


def columns(facts: Iterable[Fact], dictionary: Dictionary) -> Facts:
    """Return triples as columns."""
    pairs: dict[int, list[int]] = {}
    for subject, predicate, value in facts:
        key = dictionary.intern_term(subject) << 32 | dictionary.intern_term(value)
        pairs.setdefault(dictionary.intern_term(predicate), []).append(key)
    found = Facts()
    for identifier, keys in pairs.items():
        found.replace(identifier, distinct(np.array(keys, np.int64)))
    return found


def tuples(facts: Facts, dictionary: Dictionary) -> set[Fact]:
    """Return columns as triples."""
    terms: dict[int, Term] = {}

    def term(identifier: int) -> Term:
        if identifier not in terms:
            terms[identifier] = dictionary.term(identifier)
        return terms[identifier]

    return {
        (term(subject), term(predicate), term(value))
        for predicate, keys in facts
        for subject, value in zip(*(column.tolist() for column in unpack(keys)), strict=True)
    }


def inferred(rules: Iterable[Rule], asserted: Iterable[Fact], limits: Limits | None = None) -> set[Fact]:
    """Return the inferences of the engine."""
    dictionary = Dictionary()
    outcome = evaluate(Program(rules), dictionary, columns(asserted, dictionary), limits=limits)
    return tuples(outcome.inferred, dictionary)
