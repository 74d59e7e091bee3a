from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import BlankNode, Literal, NamedNode, Store, Triple

from kg.rules.form import TripleTerm, Variable
from kg.syntax import tree
from kg.syntax.parser import parse_rq

if TYPE_CHECKING:
    from kg.syntax.tree import Expression, RuleText

E = "http://e/"
XSD = "http://www.w3.org/2001/XMLSchema#"


def rule(text: str) -> RuleText:
    """Parse a rule with the empty prefix declared."""
    return parse_rq(f"PREFIX : <{E}>\n{text}", "x.rq").rules[0]


def body(text: str) -> tuple[tree.Node, ...]:
    """Parse the content of WHERE."""
    return rule(f"CONSTRUCT {{ }} WHERE {{ {text} }}").group.nodes


def expression(text: str) -> Expression:
    """Parse an expression."""
    (node,) = body(f"BIND({text} AS ?x)")
    assert isinstance(node, tree.Bind)
    return node.expression


def test_blank_nodes_are_new_in_templates_and_variables_in_patterns() -> None:
    """A label is a blank node in a template and an otherwise unnameable variable in a pattern."""
    parsed = rule("CONSTRUCT { _:b :p [ :q _:b ] } WHERE { _:b :p [] }")
    assert parsed.template[0].subject == BlankNode("b") == parsed.template[1].object
    (pattern,) = parsed.group.nodes
    assert isinstance(pattern, tree.TriplePattern)
    assert pattern.subject == Variable(".b")
    assert isinstance(pattern.object, Variable)
    assert pattern.object.name.startswith(".")


def test_made_labels_are_not_those_of_the_text() -> None:
    """A generated label never equals one in the text."""
    parsed = rule("CONSTRUCT { _:g1 :p [ :q _:gg1 ] } WHERE { }")
    assert len({parsed.template[0].subject, parsed.template[0].object, parsed.template[1].object}) == 3


def test_the_short_form_is_template_and_pattern() -> None:
    """CONSTRUCT WHERE derives its matches."""
    parsed = rule("CONSTRUCT WHERE { ?s :p _:b , 1 }")
    assert [triple.object for triple in parsed.template] == [BlankNode("b"), Literal(1)]
    assert [node.object for node in parsed.group.nodes if isinstance(node, tree.TriplePattern)] == [
        Variable(".b"),
        Literal(1),
    ]


def test_triples_know_their_place() -> None:
    """The span of a triple begins at its first new part: subject, predicate or object."""
    text = "CONSTRUCT { } WHERE { ?s :p 1 , 2 ; :q 3 }"
    whole = f"PREFIX : <{E}>\n{text}"
    spans = [node.span for node in body("?s :p 1 , 2 ; :q 3")]
    assert [whole[span.start : span.end] for span in spans] == ["?s :p 1", "2", ":q 3"]


def test_triple_terms_without_variables_are_terms() -> None:
    """A triple term of known terms is a constant; one with a variable or a blank node is instantiated."""
    known, open_ = body("?s :p <<( :a :b 1 )>> , <<( :a :b ?x )>>")
    assert isinstance(known, tree.TriplePattern)
    assert known.object == Triple(NamedNode(f"{E}a"), NamedNode(f"{E}b"), Literal(1))
    assert isinstance(open_, tree.TriplePattern)
    assert isinstance(open_.object, TripleTerm)


@pytest.mark.parametrize(
    ("written", "negated"),
    [
        ("EXISTS { ?s :p 1 }", False),
        ("NOT EXISTS { ?s :p 1 }", True),
        ("(NOT EXISTS { ?s :p (1) })", True),
        ("(!EXISTS { ?s :p 1 })", True),
        ("(!(NOT EXISTS { ?s :p 1 }))", False),
    ],
)
def test_a_filter_of_exists_alone_is_exists(written: str, negated: bool) -> None:  # noqa: FBT001 - a column of a table
    """A filter that consists of EXISTS, with any brackets and signs around it, is EXISTS."""
    (node,) = body(f"FILTER {written}")
    assert isinstance(node, tree.Exists)
    assert node.negated is negated


def test_a_filter_with_more_than_exists_stays_a_filter() -> None:
    """EXISTS inside an expression remains there, and is recorded by the expression."""
    (node,) = body("FILTER (EXISTS { ?s :p ?o } || ?x)")
    assert isinstance(node, tree.Filter)
    assert node.expression.variables == ("s", "o", "x")
    assert len(node.expression.exists) == 1


def test_an_expression_is_spelt_without_prefixes() -> None:
    """Names become IRIs, comments are removed, signs of numbers are preserved, keywords have the engine's spelling."""
    found = expression('xsd:integer( ?a )<-1&&?b IN(:c,"x"^^:t, TRUE) # c\n || ! :f(2)')
    xsd = "http://www.w3.org/2001/XMLSchema#"
    assert found.text == f'<{xsd}integer>(?a) < -1 && ?b IN (<{E}c>, "x"^^<{E}t>, true) || !<{E}f>(2)'
    assert found.variables == ("a", "b")


def test_a_rule_lists_its_calls_at_any_depth() -> None:
    """Names of built-in functions are in upper case, others are IRIs; each call has its arguments and its place."""
    text = "CONSTRUCT { } WHERE { FILTER EXISTS { BIND(strlen(:f(?a, 1)) AS ?x) FILTER xsd:integer() } }"
    whole = f"PREFIX : <{E}>\n{text}"
    calls = [(call.name, call.arguments, whole[call.span.start : call.span.end]) for call in rule(text).calls]
    cast = "http://www.w3.org/2001/XMLSchema#integer"
    assert calls == [(f"{E}f", 2, ":f"), ("STRLEN", 1, "strlen"), (cast, 0, "xsd:integer")]


def test_aggregates_are_found_and_can_be_replaced() -> None:
    """An expression has its aggregates with their placeholder text; their variables are not free in it."""
    (node,) = body(
        '{ SELECT ?k (1 + group_concat(DISTINCT STR(?o) ; separator = ",") AS ?n) { ?k :p ?o } GROUP BY ?k }'
    )
    assert isinstance(node, tree.SubSelect)
    found = node.projections[1].expression
    assert found is not None
    (call,) = found.aggregates
    assert (call.function, call.distinct, call.separator) == ("GROUP_CONCAT", True, ",")
    assert call.text in found.text
    assert found.variables == ()
    assert call.argument is not None
    assert call.argument.variables == ("o",)


def test_aggregates_may_follow_a_pattern_in_a_column() -> None:
    """A sub-SELECT inside EXISTS leaves it to the column around whether it may have aggregates."""
    (node,) = body(
        "{ SELECT (EXISTS { { SELECT (COUNT(*) AS ?c) { ?a :p ?b } } } && COUNT(?o) > 1 AS ?n) { ?k :p ?o } }"
    )
    assert isinstance(node, tree.SubSelect)
    found = node.projections[0].expression
    assert found is not None
    assert [call.function for call in found.aggregates] == ["COUNT"]


def test_values_behind_a_selection_stand_in_its_group() -> None:
    """VALUES after a sub-SELECT joins with its group."""
    (node,) = body("{ SELECT ?s { ?s :p ?o } VALUES ?s { :a } }")
    assert isinstance(node, tree.SubSelect)
    assert isinstance(node.group.nodes[-1], tree.ValuesBlock)


@pytest.mark.parametrize(
    "text",
    [
        "?s :p -1 , +2.5 , .5e3 , TRUE VALUES ?s { -1 UNDEF <<( :a :b -2 )>> }",
        "?s ?p ?o FILTER(?o<1&&?s<?p||?o>-1) FILTER(1 -1 = ?o)",
        "?s :p ( 1 [ :q ?x ] () ) , [] . FILTER NOT EXISTS { ?s :r ?o ; :p 'a'@en--ltr , \"b\"@fr }",
        "{ SELECT ?s (COUNT(*) AS ?n) (SUM(?o + 1) AS ?m) { ?s :p ?o } GROUP BY ?s HAVING(COUNT(*) > 1) LIMIT 2 }",
        "?s (:p|^:q)+/!(:a|^:b) ?o GRAPH ?g { ?o ?p ?s ~ ?r {| :by ?x |} } OPTIONAL { << ?s ?p ?o >> :q 1 }",
    ],
)
def test_the_engine_takes_a_group_spelt_anew(text: str) -> None:
    """The text stored in a group is SPARQL that the engine parses without prefixes."""
    spelt = rule(f"CONSTRUCT {{ }} WHERE {{ {text} }}").group.text
    assert not list(Store().query(f"SELECT * WHERE {spelt}"))  # type: ignore[arg-type]  # a SELECT has solutions


def test_a_group_of_a_selection_and_more_keeps_all_of_it() -> None:
    """Braces around only a sub-SELECT are its own; with other elements they are a group."""
    (alone,) = body("{ { SELECT ?s { ?s :p ?o } } }")
    (beside,) = body("{ { SELECT ?s { ?s :p ?o } } ?s :q ?x }")
    assert isinstance(alone, tree.SubSelect)
    assert isinstance(beside, tree.Union)
    assert [len(group.nodes) for group in beside.groups] == [2]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("12", "integer"),
        ("-1", "integer"),
        ("+2.5", "decimal"),
        ("-.5", "decimal"),
        ("1e3", "double"),
        ("1.0E-2", "double"),
        ("true", "boolean"),
        ("FALSE", "boolean"),
    ],
)
def test_a_literal_has_the_type_of_its_form(text: str, kind: str) -> None:
    """Numbers keep their spelling, truth values are written in lower case."""
    (_, pattern) = body(f":s :p :o, {text}")  # after a predicate, a sign belongs to a path
    assert isinstance(pattern, tree.TriplePattern)
    assert pattern.object == Literal(text.lower() if kind == "boolean" else text, datatype=NamedNode(XSD + kind))


def test_keywords_can_have_any_case() -> None:
    """Declarations, too; IRIs are relative to the base that is declared last."""
    text = (
        "base <http://old/> Base <http://e/> prefix p: <q#> Version '1.2' construct { <a> p:b ?x } where { ?x a <a> }"
    )
    parsed = parse_rq(text, "x.rq").rules[0]
    assert (parsed.template[0].subject, parsed.template[0].predicate) == (NamedNode(E + "a"), NamedNode(E + "q#b"))


def test_keys_of_groups_can_be_expressions_with_names() -> None:
    """A named expression has its variable, another one a variable that no text can name."""
    (node,) = body("SELECT ?b { ?x :p ?y } GROUP BY (?y + 1 AS ?b) (STR(?y)) ?x")
    assert isinstance(node, tree.SubSelect)
    first, second, third = node.keys
    assert (first.variable, third.variable) == (Variable("b"), Variable("x"))
    assert second.variable.name.startswith(".")
    assert [key.expression is None for key in node.keys] == [False, False, True]
