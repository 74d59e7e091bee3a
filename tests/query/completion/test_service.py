from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kg.query.completion.service import complete
from kg.query.completion.vocabulary import KEYWORDS

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.query.completion.statistics import SnapshotCache

    Offered = Callable[[str], list[dict[str, Any]]]

PIECES = [
    *"{}()[].;,^/|?*<>=!\"'#\n ", "SELECT ", "WHERE ", "?x ", "a ", "ros:Topic ", "rnkg:publishes ", "rdfs:label ",
    "VALUES ", "GRAPH ", "FILTER", "PREFIX ", "\U0001f600", "AS ", "ORDER BY ", "_:b ", "1 ", "é", "\r\n",
]  # fmt: skip


def labels(items: list[dict[str, Any]]) -> list[str]:
    """Return the labels of items."""
    return [each["label"] for each in items]


@pytest.mark.parametrize(
    ("marked", "first"),
    [
        ("SEL|", "SELECT"),
        ("PREFIX rd|", "rdf:"),
        ("SELECT ?node { ?node a ros:Node } ORDER BY |", "?node"),
        ("ASK { ?x a top|", "ros:Topic"),
        ("ASK { ?x a rnkg:NodeT|", "rnkg:NodeType"),
        ("PREFIX rnkg: <urn:x#> ASK { ?x a NodeT|", "<https://w3id.org/rnkg/ns#NodeType>"),
        ("ASK { ?x a rnkg:NodeType ; pub|", "rnkg:publishes"),
        ("ASK { ?x rnkg:publishes ?t . ?t lab| }", "rdfs:label"),
        ("ASK { ?x rnkg:publishes/lab|", "rdfs:label"),
        ("ASK { ?t a ros:Topic ; ^rnkg:pub|", "rnkg:publishes"),
        ('ASK { ?t a ros:Topic ; rdfs:label "scan_f|', "/scan_filtered"),
        ('ASK { VALUES ?l { "scan_f|" } ?t a ros:Topic ; rdfs:label ?l }', "/scan_filtered"),
        ('ASK { ?t a ros:Topic ; rdfs:label ?l FILTER(?l = "scan_f|', "/scan_filtered"),
        ("ASK { ?e rnkg:resolution rnkg:l|", "rnkg:literal"),
        ("ASK { ?n rnkg:publishes scan_filtered|", "/scan_filtered"),
        ("ASK { ?x ?y ?z FILTER(contai|", "CONTAINS"),
        ("ASK { ?x ?y ?z OPTI|", "OPTIONAL"),
        ("SELECT * { ?x ?y ?z } ORD|", "ORDER BY"),
        ("SELECT * { ?x ?y ?z } ORDER |", "BY"),
        ("SELECT * { GRAPH <https://w3id.org/rnkg/graph/inf|", "<https://w3id.org/rnkg/graph/inferred>"),
        ("who-publ|", "explore/who-publishes"),
    ],
)
def test_offers_what_fits_first(offered: Offered, marked: str, first: str) -> None:
    """Keywords, variables, classes, properties of the subject's class, values, graphs and stored queries are found."""
    assert labels(offered(marked))[0] == first


@pytest.mark.parametrize(
    ("marked", "inserted"),
    [
        ("PREFIX rdfs|", "rdfs: <http://www.w3.org/2000/01/rdf-schema#>"),
        ('ASK { ?t a ros:Topic ; rdfs:label "scan_f|', '"/scan_filtered"'),
        ("ASK { ?n rnkg:publishes scan_filtered|", "<https://w3id.org/rnkg/topic/scan_filtered>"),
        ("ASK { ?x ?y ?z FILTER(contai|", "CONTAINS()"),
    ],
)
def test_inserts_what_the_grammar_wants(offered: Offered, marked: str, inserted: str) -> None:
    """Inserted text is complete: a declaration with its namespace, a literal with its quotes, a call with brackets."""
    assert offered(marked)[0]["insert"] == inserted


def test_properties_are_counted_by_class(offered: Offered) -> None:
    """After a subject of known class, the properties of that class come first, with the number of instances."""
    items = offered("ASK { ?x a rnkg:NodeType ; |")
    name = next(each for each in items if each["label"] == "rnkg:name")
    nodes = next(each for each in offered("ASK { ?x a rnkg:NodeTyp|") if each["label"] == "rnkg:NodeType")
    assert name["count"] == nodes["count"] > 0
    assert name["detail"] == f"{name['count']} of {nodes['count']} rnkg:NodeType"
    assert name["documentation"]
    assert "ros:hasModality" not in labels(items[: len(items) // 2])


def test_variables_of_the_whole_query_are_offered(offered: Offered) -> None:
    """SELECT offers the variables of the pattern after it."""
    assert labels(offered("SELECT ?| { ?node rnkg:publishes ?topic }")) == ["?node", "?topic"]


def test_nothing_is_offered_in_a_comment(offered: Offered) -> None:
    """There are no completions in comments."""
    assert offered("ASK { # sel|") == []


def test_a_prefix_that_the_query_lacks_is_declared(offered: Offered) -> None:
    """A name comes with an edit that declares its prefix: after the other declarations, once."""
    lacking = "PREFIX ros: <http://data.mksmart.org/onto-ros/class#>\nASK { ?x a rnkg:NodeTyp|"
    (edit,) = offered(lacking)[0]["edits"]
    assert edit == {"start": 54, "end": 54, "text": "PREFIX rnkg: <https://w3id.org/rnkg/ns#>\n"}
    assert offered("PREFIX rnkg: <https://w3id.org/rnkg/ns#> ASK { ?x a rnkg:NodeTyp|")[0]["edits"] == []


def test_holes_lie_in_brackets(offered: Offered) -> None:
    """Offsets mark the places to fill in the inserted text."""
    items = {each["label"]: each for each in offered("ASK { |")}
    assert items["FILTER"]["insert"][: items["FILTER"]["holes"][0]] == "FILTER("
    optional = items["OPTIONAL"]
    assert [optional["insert"][:hole] for hole in optional["holes"]] == ["OPTIONAL { "]
    assert all(hole <= len(each["insert"]) for each in items.values() for hole in each["holes"])
    assert KEYWORDS["BIND"][0] == items["BIND"]["insert"]


@settings(max_examples=150, deadline=None)
@given(text=st.lists(st.sampled_from(PIECES), max_size=14).map("".join), share=st.floats(0, 1))
def test_completes_anything(kept: SnapshotCache, text: str, share: float) -> None:
    """Completion never fails, and its ranges and edits are within the text."""
    position = int(len(text) * share)
    found = complete(text, position, kept)
    assert 0 <= found["range"]["start"] <= position <= found["range"]["end"] <= len(text)
    for item in found["items"]:
        assert all(0 <= edit["start"] <= edit["end"] <= len(text) for edit in item["edits"])
