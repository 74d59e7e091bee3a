from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from syntax.printing import group_text, plain, template_text
from syntax.trees import groups, templates

from kg.errors import RuleError
from kg.syntax.parser import parse_rq, parse_srl

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.syntax.tree import Group, RuleUnit, TriplePattern

CASES = Path(__file__).parent.parent / "rules" / "notations" / "srl"
SETS = [path.read_text() for path in sorted(CASES.rglob("*.srl"))]
VOCABULARY = """
    CONSTRUCT WHERE RULE DATA NOT EXISTS SET FILTER BIND VALUES SELECT GROUP BY AS UNDEF UNION OPTIONAL COUNT STR REGEX
    PREFIX BASE IMPORTS VERSION { } ( ) [ ] << >> <<( )>> {| |} ~ . ; , a ?x $y _:b <http://e/> : rdf:type 1 -2 .5 1e
    'x' \"\"\" @en--ltr ^^ ^ / | * + ? ! = < <= && || := \\ #
"""
WORDS = st.lists(st.sampled_from([*VOCABULARY.split(), "\n", "\ud800", "é", "\x00"]), max_size=30)
TEXTS = st.one_of(st.text(max_size=60), WORDS.map(" ".join), WORDS.map("".join))
OPENINGS = ["{", "[ :p ", "(", "FILTER((", "FILTER(!", "<<( ", "<< ", "OPTIONAL {", "{ SELECT * {"]


def refusal(parse: Callable[[str, str], RuleUnit], text: str) -> RuleError | None:
    """Return the error of a text, or None if it parses."""
    try:
        parse(text, "x")
    except RuleError as error:
        return error
    return None


@given(templates, groups())
def test_the_print_of_a_tree_parses_to_that_tree(template: tuple[TriplePattern, ...], group: Group) -> None:
    """Parsing the text of a tree gives the tree."""
    text = f"CONSTRUCT {{ {template_text(template)} }} WHERE {group_text(group)}"
    (rule,) = parse_rq(text, "x.rq").rules
    assert plain(rule.template) == plain(template)
    assert plain(rule.group) == plain(group)


@given(groups())
def test_a_group_spelt_anew_means_the_same(group: Group) -> None:
    """The text stored in a group parses to the group without any prefix."""
    (rule,) = parse_rq(f"CONSTRUCT {{ }} WHERE {group_text(group)}", "x.rq").rules
    (again,) = parse_rq(f"CONSTRUCT {{ }} WHERE {rule.group.text}", "x.rq").rules
    assert plain(again.group) == plain(rule.group)


@pytest.mark.parametrize("parse", [parse_rq, parse_srl])
@given(TEXTS)
def test_any_text_gives_a_tree_or_an_error_with_a_place(parse: Callable[[str, str], RuleUnit], text: str) -> None:
    """Any text is parsed, or rejected with a place."""
    error = refusal(parse, text)
    assert error is None or (error.code in {"KG201", "KG209"} and error.place is not None and error.place.line)


@settings(max_examples=200)
@given(st.sampled_from(SETS), st.integers(0, 10_000), st.integers(0, 3), TEXTS)
def test_a_damaged_rule_set_gives_a_tree_or_an_error(text: str, at: int, gone: int, other: str) -> None:
    """A rule set with a part removed or inserted is parsed or rejected."""
    at %= len(text) + 1
    error = refusal(parse_srl, text[:at] + other[:3] + text[at + gone :])
    assert error is None or error.code == "KG201"


@pytest.mark.parametrize("iri", ["\ud800http://example.org/", "http://example.org/\ud800"])
def test_an_unpaired_surrogate_in_an_iri_is_refused(iri: str) -> None:
    """An IRI that cannot be encoded is an error, relative or not."""
    error = refusal(parse_srl, f"PREFIX : <{iri}>\nRULE {{ ?s :half ?h }} WHERE {{ ?s :p ?o }}\n")
    assert error is not None
    assert error.code == "KG201"


@pytest.mark.parametrize(("opening", "closing"), [("(", ")"), ("!", "")])
def test_a_deep_expression_is_valid_but_not_allowed(opening: str, closing: str) -> None:
    """What the limit refuses is no error of syntax: the engine has no such limit."""
    error = refusal(parse_rq, f"CONSTRUCT {{}} WHERE {{ ?s ?p ?o FILTER({opening * 101}?o{closing * 101}) }}")
    assert error is not None
    assert error.code == "KG209"


@pytest.mark.parametrize(
    "opening", ["{", "[ :p ", "(", "FILTER((", "FILTER(!", "<<( ", "<< ", "OPTIONAL {", "{ SELECT * {"]
)
@pytest.mark.parametrize("parse", [parse_rq, parse_srl])
def test_deep_nesting_is_refused(parse: Callable[[str, str], RuleUnit], opening: str) -> None:
    """Brackets beyond the limit are an error, without a crash."""
    head = "CONSTRUCT {} WHERE {" if parse is parse_rq else "RULE {} WHERE {"
    with pytest.raises(RuleError) as caught:
        parse(f"PREFIX : <http://e/> {head} {opening * 100_000}", "x")
    assert caught.value.code in {"KG201", "KG209"}
