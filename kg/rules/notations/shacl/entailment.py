"""Entailment regimes that a shapes graph asks for with sh:entailment (SHACL, section 1.5; SHACL-AF, section 8.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.rules.notations.shacl.vocabulary import RDFS, SUBCLASS, TYPE, sh

if TYPE_CHECKING:
    from kg.rules.notations.shacl.graph import ShapesGraph

__all__ = ["entailed"]

_REGIME: Final = "http://www.w3.org/ns/entailment/"
_PROPERTY: Final = f"<{RDFS}subPropertyOf>"

_RDFS: Final = (
    f"CONSTRUCT {{ ?x {TYPE} ?c }} WHERE {{ ?p <{RDFS}domain> ?c . ?x ?p ?y . }}",
    f"CONSTRUCT {{ ?y {TYPE} ?c }} WHERE {{ ?p <{RDFS}range> ?c . ?x ?p ?y . FILTER(!isLiteral(?y)) }}",
    f"CONSTRUCT {{ ?p {_PROPERTY} ?r }} WHERE {{ ?p {_PROPERTY} ?q . ?q {_PROPERTY} ?r . }}",
    f"CONSTRUCT {{ ?x ?q ?y }} WHERE {{ ?p {_PROPERTY} ?q . ?x ?p ?y . }}",
    f"CONSTRUCT {{ ?x {TYPE} ?d }} WHERE {{ ?c {SUBCLASS} ?d . ?x {TYPE} ?c . }}",
    f"CONSTRUCT {{ ?c {SUBCLASS} ?e }} WHERE {{ ?c {SUBCLASS} ?d . ?d {SUBCLASS} ?e . }}",
)
"""rdfs2, 3, 5, 7, 9 and 11 of RDF 1.1 Semantics (section 9.2.1). Those that say of each name that it is a resource, a
property or a class, and a part of itself, derive nothing that a rule could tell apart."""


def entailed(graph: ShapesGraph) -> tuple[tuple[str, ...], int]:
    """Return the rules of the regimes that the file asks for, and where it does.

    Raises `RuleError` KG230 for a regime that is not supported: SHACL wants a failure.
    """
    rules: tuple[str, ...] = ()
    offset = 0
    for node in graph.subjects(sh("entailment")):
        for regime in graph.values(node, sh("entailment")):
            if regime == sh("Rules"):
                continue
            found = graph.places.of_name(regime.value) if isinstance(regime, NamedNode) else None
            if regime != NamedNode(f"{_REGIME}RDFS"):
                hint = f"There are sh:Rules and <{_REGIME}RDFS>; for OWL 2 RL put the rules of rules/owl in force."
                what = f"the entailment regime {regime} is not supported"
                raise graph.error(what, node, code="KG230", hint=hint, offset=found)
            rules, offset = _RDFS, found or 0
    return rules, offset
