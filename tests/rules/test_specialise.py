"""Rules over a schema: specialised to it, they infer the same, and have better strata."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import NamedNode, RdfFormat, Triple, parse
from rules.forms import rule

from kg.errors import RuleError
from kg.graph.ontology_files import ontology_triples
from kg.resources import folder
from kg.rules.authoring.runs import infer
from kg.rules.engine.evaluate import Program
from kg.rules.form import Values, Variable
from kg.rules.reading import discover
from kg.rules.specialise import SCHEMA_PREDICATES, is_schema, specialise
from kg.rules.stratify import stratify
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable


OWL = tuple(each for each in discover([folder("rules")], families=["owl"]).rules)
NAMES = st.sampled_from([NamedNode(f"urn:x:{letter}") for letter in "abcdef"])
RDF_TYPE = NamedNode(PREFIXES["rdf"] + "type")
SYMMETRIC, RELATION = (NamedNode(PREFIXES["owl"] + name) for name in ("SymmetricProperty", "ObjectProperty"))
AXIOMS = st.builds(Triple, NAMES, st.sampled_from(sorted(SCHEMA_PREDICATES, key=str)[-4:]), NAMES)
KINDS = st.builds(Triple, NAMES, st.just(RDF_TYPE), st.sampled_from([SYMMETRIC, RELATION]))
FACTS = st.builds(Triple, NAMES, st.one_of(NAMES, st.just(RDF_TYPE)), NAMES)


def triples(text: str) -> list[Triple]:
    """Parse Turtle; `:` is urn:x:."""
    head = "".join(f"PREFIX {name}: <{iri}>\n" for name, iri in {**PREFIXES, "": "urn:x:"}.items())
    return [quad.triple for quad in parse(head + text, RdfFormat.TURTLE)]


def schema(found: Iterable[Triple]) -> list[Triple]:
    """Return the triples about the schema."""
    return [each for each in found if is_schema(each.predicate, each.object)]


@given(st.lists(st.one_of(AXIOMS, KINDS, FACTS), max_size=25))
@settings(deadline=None, max_examples=60)
def test_rules_cut_to_the_schema_infer_the_same(data: list[Triple]) -> None:
    """For any schema and data, the active OWL rules give the same triples, specialised or not."""
    cut = specialise(OWL, schema(data))
    assert infer(Program(cut), data)[0] == infer(Program(OWL), data)[0]


def test_one_rule_for_each_axiom() -> None:
    """An axiom gives a plain rule with its input and output predicates; parts are numbered from one."""
    cut = specialise(OWL, triples(":p rdfs:subPropertyOf :q . :q rdfs:subPropertyOf :r ."))
    found = [each for each in cut if each.name == "owl/prp-spo1"]
    written = [(str(each.body[0].predicate), str(each.head[0].predicate)) for each in found]  # type: ignore[union-attr]  # atoms
    assert written == [("<urn:x:p>", "<urn:x:q>"), ("<urn:x:p>", "<urn:x:r>"), ("<urn:x:q>", "<urn:x:r>")]
    assert [each.part for each in found] == [1, 2, 3]


def test_negation_beside_rules_over_a_schema_can_be_stratified() -> None:
    """The shipped rules can be stratified, but not while some of them write any predicate."""
    shipped = discover([folder("rules")]).rules
    axioms = [quad.triple for quad in parse(ontology_triples(), RdfFormat.N_TRIPLES)]
    assert stratify(specialise(shipped, axioms))
    with pytest.raises(RuleError, match="KG202"):
        stratify(shipped)


def test_rules_that_derive_schema_from_data_leave_all_as_it_is() -> None:
    """If data creates axioms, the set of axioms is not final."""
    derives = rule("?x =http://www.w3.org/2000/01/rdf-schema#subClassOf ?y", "?x :below ?y")
    rules = (*OWL, derives)
    assert specialise(rules, triples(":A rdfs:subClassOf :B .")) == rules


def test_a_class_without_a_name_is_bound_by_a_row() -> None:
    """A blank node in a head would be a new one, so it is bound by a row of values."""
    kind, domain = "=http://www.w3.org/1999/02/22-rdf-syntax-ns#type", "=http://www.w3.org/2000/01/rdf-schema#domain"
    general = rule(f"?x {kind} ?c", f"?p {domain} ?c . ?x ?p ?y")
    (cut,) = specialise([general], triples(":p rdfs:domain [] ."))
    assert isinstance(cut.body[0], Values)
    assert cut.body[0].variables == (Variable("c"),)


def test_rules_without_schema_stay_as_they_are() -> None:
    """Rules about data only are returned unchanged."""
    plain = rule("?x :q ?y", "?x :p ?y")
    assert specialise([plain], triples(":p rdfs:domain :C .")) == (plain,)
