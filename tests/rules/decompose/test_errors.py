from __future__ import annotations

import pytest
from pyoxigraph import NamedNode
from rules.decompose.applying import read
from rules.engine.comparing import inferred

from kg.errors import Place, RuleError
from kg.rules.decompose.groups import MOST_PARTS
from kg.rules.form import EngineBlock


def test_a_variable_of_the_head_that_nothing_binds_is_refused() -> None:
    """KG203 has the variable, its place and instructions."""
    text = "CONSTRUCT {\n  ?x <urn:h> ?z }\nWHERE { ?x <urn:p> ?y FILTER(?z > 1) MINUS { ?y <urn:q> ?z } }"
    with pytest.raises(RuleError) as caught:
        read(text)
    assert caught.value.code == "KG203"
    assert "`?z`" in caught.value.message
    assert caught.value.place == Place("rule.rq", 2, 14, "  ?x <urn:h> ?z }", 2, 16)
    assert caught.value.hint


def test_a_misspelt_variable_of_the_head_is_suggested() -> None:
    """KG203 suggests a bound variable of nearly the same name, not one that only contains it."""
    for body, hint in (("?node <urn:p> ?n1", "Did you mean `?node`?"), ("?scanner_node <urn:p> ?other", "Bind `?nod`")):
        with pytest.raises(RuleError) as caught:
            read(f"CONSTRUCT {{ ?nod <urn:h> 1 }} WHERE {{ {body} }}")
        assert (caught.value.hint or "").startswith(hint)


@pytest.mark.parametrize(
    "body", ["{ ?x <urn:p> ?y SERVICE <urn:s> { ?x <urn:q> ?y } }", "FROM <urn:g> WHERE { ?x ?p ?y }"]
)
def test_other_servers_and_data_sets_are_refused(body: str) -> None:
    """KG209 for SERVICE and FROM."""
    with pytest.raises(RuleError) as caught:
        read(f"CONSTRUCT {{ ?x <urn:h> ?y }} {body if body.startswith('FROM') else f'WHERE {body}'}")
    assert caught.value.code == "KG209"


NAME = "BNODE() must be the value of a variable that only the head has, behind all patterns"


@pytest.mark.parametrize(
    ("body", "code", "message"),
    [
        ("?x <urn:p> ?y BIND(§struuid() AS ?z)", "KG209", "STRUUID is not allowed in rules: its value differs"),
        ("?x <urn:p> ?y BIND(IRI(§UUID()) AS ?z)", "KG209", "UUID is not allowed in rules: its value differs"),
        ("?x <urn:p> ?y, ?z FILTER(§RAND() < 0.5)", "KG209", "RAND is not allowed in rules: its value differs"),
        ("?x <urn:p> ?z MINUS { ?x <urn:q> ?y FILTER(?y < §NOW()) }", "KG209", "NOW is not allowed in rules"),
        ("{ SELECT ?x (MAX(§RAND()) AS ?z) { ?x ?p ?y } GROUP BY ?x }", "KG209", "RAND is not allowed in rules"),
        ("?x <urn:p> ?y BIND(§<urn:f>(?y) AS ?z)", "KG209", "the function <urn:f> does not exist"),
        ("?x <urn:p> ?z FILTER EXISTS { ?z ?p ?y FILTER §<urn:f>(?y) }", "KG209", "the function <urn:f> does not"),
        ("?x <urn:p> ?y BIND(§xsd:int(?y) AS ?z)", "KG209", "the function xsd:int does not exist"),
        ("?x <urn:p> ?y BIND(§xsd:integer(?y, 1) AS ?z)", "KG201", "xsd:integer takes 1 argument, not 2"),
        ("?x <urn:p> ?y BIND(§BNODE(STR(?y)) AS ?z)", "KG209", NAME),
        ("BIND(§BNODE() AS ?z) ?x <urn:p> ?y", "KG209", NAME),
        ("?x <urn:p> ?y { BIND(§BNODE() AS ?z) }", "KG209", NAME),
        ("?x <urn:p> ?y BIND(BNODE() AS ?z) §FILTER(isBlank(?z))", "KG209", NAME),
        ("?x <urn:p> ?z FILTER(isBlank(§BNODE()))", "KG209", NAME),
    ],
)
def test_functions_that_rules_cannot_call_are_refused(body: str, code: str, message: str) -> None:
    """The error is at the call, at any depth, and says what to write instead."""
    before, after = f"CONSTRUCT {{ ?x <urn:h> ?z }} WHERE {{ {body} }}".split("§")
    with pytest.raises(RuleError) as caught:
        read(before + after)
    place = caught.value.place
    assert place is not None
    assert (caught.value.code, caught.value.message[: len(message)]) == (code, message)
    assert place.column == len(before) + 1
    assert caught.value.hint


def test_bnode_is_a_node_of_the_head() -> None:
    """One new node for each solution and name; the nodes of the head keep theirs."""
    created = 'BIND(BNODE() AS ?b) BIND(BNODE("k") AS ?c) BIND(BNODE("k") AS ?d)'
    body = "?x <urn:p> ?y OPTIONAL { ?y <urn:q> ?v }"
    found = read(f"CONSTRUCT {{ ?x <urn:h> ?b , ?c , ?d , _:b }} WHERE {{ {body} {created} }}")
    plain = read(f"CONSTRUCT {{ ?x <urn:h> _:b1 , _:c , _:b }} WHERE {{ {body} }}")
    assert [set(rule.head) for rule in found] == [set(rule.head) for rule in plain]
    assert [rule.body for rule in found] == [rule.body for rule in plain]


def test_a_variable_with_the_name_of_a_generated_one_is_another() -> None:
    """Printed rules have such names; a filter that is added to one sees the variable that it names."""
    rules = read("CONSTRUCT { ?x <urn:h> ?_·1 } WHERE { ?x <urn:p>/<urn:q> ?_·1 FILTER(?_·1 != <urn:b>) }")
    a, b, c, p, q = (NamedNode(f"urn:{name}") for name in "abcpq")
    assert inferred(rules, [(a, p, b), (b, q, c)]) == {(a, NamedNode("urn:h"), c)}


def test_too_many_parts_stay_one_rule_of_the_engine() -> None:
    """Choices multiply; above the limit the rule is one block, below it parts."""
    choice = " ".join(f"{{ ?x <urn:p{number}> ?y }} UNION {{ ?x <urn:q{number}> ?y }}" for number in range(7))
    (rule,) = read(f"CONSTRUCT {{ ?x <urn:h> ?y }} WHERE {{ {choice} }}")
    assert isinstance(rule.body[0], EngineBlock)
    fewer = choice.split(" { ?x <urn:p6>")[0]
    assert len(read(f"CONSTRUCT {{ ?x <urn:h> ?y }} WHERE {{ {fewer} }}")) == MOST_PARTS


def test_equal_paths_of_two_rules_share_their_auxiliary_predicate() -> None:
    """The predicate is named after the path, and its rules differ only in the name of their origin."""
    one = read("CONSTRUCT { ?x <urn:h> ?y } WHERE { ?x (<urn:p>|<urn:q>)+ ?y }")
    two = read("CONSTRUCT { ?a <urn:k> ?a } WHERE { ?b <urn:r> ?a . ?b (<urn:q>|<urn:p>)+ ?a }")
    assert {rule.head for rule in one[1:]} == {rule.head for rule in two[1:]}
    assert {rule.body for rule in one[1:]} == {rule.body for rule in two[1:]}
