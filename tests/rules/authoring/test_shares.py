from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pyoxigraph import Literal, NamedNode
from rules.authoring.worlds import EX, files, write_rules

from kg.rules.authoring.runs import Share, shares
from kg.rules.engine.facts import Facts, distinct
from kg.rules.engine.terms import Dictionary
from kg.rules.reports import Difference, RunReport, Seconds

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.engine.facts import Keys

RULES = {
    "knows": "CONSTRUCT { ?x :knows ?y } WHERE { ?x :met ?y }",
    "back": "CONSTRUCT { ?y :knows ?x } WHERE { ?x :met ?y }",
    "old": "CONSTRUCT { ?x a :Old } WHERE { ?x :age ?n FILTER(?n > 99) }",
    "one": "CONSTRUCT { ?x :is 1 } WHERE { ?x :met ?y }",
}


def facts(dictionary: Dictionary, *triples: tuple[str, str, str | int]) -> Facts:
    """Return triples as columns; `a` is the property of types."""
    found = Facts()
    kind = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type"
    for subject, predicate, value in triples:
        property_ = NamedNode(kind if predicate == "a" else EX + predicate)
        thing = NamedNode(EX + value) if isinstance(value, str) else Literal(value)
        ends = [dictionary.intern_term(NamedNode(EX + subject)), dictionary.intern_term(thing)]
        keys = found.keys(dictionary.intern_term(property_))
        found.replace(dictionary.intern_term(property_), sorted_with(keys, ends[0] << 32 | ends[1]))
    return found


def sorted_with(keys: Keys, key: int) -> Keys:
    """Return sorted keys with one more."""
    return distinct(np.append(keys, key))


def test_triples_are_told_of_the_rules_whose_heads_they_fit(tmp_path: Path) -> None:
    """Triples are attributed to matching heads: rules with one head together, a rule for a class alone, or no rule."""
    rules = tuple(rule for file in files(write_rules(tmp_path, **RULES)) for rule in file.rules)
    dictionary = Dictionary()
    added = facts(dictionary, ("a", "knows", "b"), ("b", "knows", "a"), ("a", "a", "Old"), ("a", "is", 1))
    removed = facts(dictionary, ("c", "knows", "b"), ("a", "a", "Young"))
    change = Difference(dictionary, added, removed)
    report = RunReport(9, 5, 4, 2, Seconds(), 1, "incremental", (), change, rules)
    assert shares(report) == [
        Share((), 0, 1),
        Share(("f/back", "f/knows"), 2, 1),
        Share(("f/old",), 1, 0),
        Share(("f/one",), 1, 0),
    ]
