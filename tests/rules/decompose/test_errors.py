from __future__ import annotations

import pytest
from rules.decompose.applying import read

from kg.errors import Place, RuleError
from kg.rules.decompose.groups import MOST_PARTS
from kg.rules.form import EngineBlock


def test_a_variable_of_the_head_that_nothing_binds_is_refused() -> None:
    """KG203 has the variable, its triple and instructions."""
    text = "CONSTRUCT {\n  ?x <urn:h> ?z }\nWHERE { ?x <urn:p> ?y FILTER(?z > 1) MINUS { ?y <urn:q> ?z } }"
    with pytest.raises(RuleError) as caught:
        read(text)
    assert caught.value.code == "KG203"
    assert "`?z`" in caught.value.message
    assert caught.value.place == Place("rule.rq", 2, 3, "  ?x <urn:h> ?z }")
    assert caught.value.hint


@pytest.mark.parametrize(
    "body", ["{ ?x <urn:p> ?y SERVICE <urn:s> { ?x <urn:q> ?y } }", "FROM <urn:g> WHERE { ?x ?p ?y }"]
)
def test_other_servers_and_data_sets_are_refused(body: str) -> None:
    """KG209 for SERVICE and FROM."""
    with pytest.raises(RuleError) as caught:
        read(f"CONSTRUCT {{ ?x <urn:h> ?y }} {body if body.startswith('FROM') else f'WHERE {body}'}")
    assert caught.value.code == "KG209"


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
