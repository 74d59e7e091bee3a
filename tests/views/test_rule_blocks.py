"""The views of the block editor of rules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import msgspec
import pytest

from kg.errors import RuleError, UnknownNameError, UsageError
from kg.views.rule_blocks import blocks_check, blocks_open, blocks_try
from kg.views.rule_vocabulary import blocks

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

LISTENS: Final[dict[str, Any]] = {
    "name": "wiring/listens-to",
    "title": "Who listens to whom",
    "why": "It tells whom a node hears.",
    "when": [
        {
            "block": "fact",
            "id": "first",
            "subject": {"term": "thing", "name": "listener"},
            "property": "rnkg:subscribes",
            "object": {"term": "thing", "name": "topic"},
        },
        {
            "block": "fact",
            "id": "second",
            "subject": {"term": "thing", "name": "speaker"},
            "property": "rnkg:publishes",
            "object": {"term": "thing", "name": "topic"},
        },
    ],
    "then": [
        {
            "block": "fact",
            "id": "head",
            "subject": {"term": "thing", "name": "listener"},
            "property": "my:listensTo",
            "object": {"term": "thing", "name": "speaker"},
        }
    ],
}


def _with(**changes: Any) -> dict[str, Any]:
    return {**LISTENS, **changes}


def test_the_vocabulary_knows_what_goes_together(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Properties have domain, range and their uses for a class; classes have their superclasses."""
    found = blocks(snapshot, settings, fresh="1")
    assert found["ready"]
    publishes = next(one for one in found["properties"] if one["name"] == "rnkg:publishes")
    assert (publishes["label"], publishes["from"], publishes["to"]) == ("publishes", ["ros:Node"], ["ros:Topic"])
    assert publishes["of"]["ros:Node"] > 20
    assert not publishes["literal"]
    label = next(one for one in found["properties"] if one["name"] == "rdfs:label")
    assert label["literal"]
    topic = next(one for one in found["classes"] if one["name"] == "ros:Topic")
    assert topic["count"] > 100
    assert topic["supers"] == ["ros:Mode"]


def test_rules_and_examples_are_offered(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Rules in SPARQL can be opened, and the examples have blocks that pass the check without a warning."""
    found = blocks(snapshot, settings)
    names = {one["name"] for one in found["rules"]}
    assert "communication/feeds" in names
    assert "communication/publishes" not in names  # in SPARQL RL
    assert [one["name"] for one in found["examples"]] == [
        "drivers/laser-driver",
        "wiring/listens-to",
        "wiring/waits-in-vain",
    ]
    for one in found["examples"]:
        answer = blocks_check(snapshot, settings, rule=msgspec.to_builtins(one["rule"]))
        assert {finding["severity"] for finding in answer["findings"]} <= {"note"}


def test_blocks_become_text_and_findings(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The response has the text of the rule, and the findings of the check at their blocks."""
    found = blocks_check(snapshot, settings, rule=LISTENS)
    assert "CONSTRUCT { ?listener my:listensTo ?speaker }" in found["text"]
    assert [(one["code"], one["id"]) for one in found["findings"]] == [("KG215", "head")]
    misspelt = _with(when=[{**LISTENS["when"][0], "property": "rnkg:subscribs"}, LISTENS["when"][1]])
    codes = {one["code"]: one["id"] for one in blocks_check(snapshot, settings, rule=misspelt)["findings"]}
    assert codes["KG211"] == codes["KG213"] == "first"


def test_a_head_without_a_pattern_is_found(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A variable only in the conclusion is an error there; with `brief` such errors are omitted."""
    rule = _with(when=LISTENS["when"][:1])
    (found,) = blocks_check(snapshot, settings, rule=rule)["findings"]
    assert (found["code"], found["severity"], found["id"]) == ("KG203", "error", "head")
    assert blocks_check(snapshot, settings, rule=rule, brief="1")["findings"] == []


def test_what_the_documentation_lacks(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Missing documentation is named by the fields of the blocks; other findings name none."""
    found = blocks_check(snapshot, settings, rule=_with(title="", why=""))["findings"]
    assert {one["code"]: one["lacks"] for one in found} == {"KG215": (), "KG218": ("title", "why")}


def test_text_becomes_blocks(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A text is converted to blocks; a text with a syntax error gets its error and no blocks."""
    text = blocks_check(snapshot, settings, rule=LISTENS, brief="1")["text"]
    found = blocks_check(snapshot, settings, text=text, name="wiring/listens-to")
    assert found["rule"].title == "Who listens to whom"
    assert len(found["rule"].when) == 2
    broken = blocks_check(snapshot, settings, text=text.replace("WHERE {", "WHERE"), name="wiring/listens-to")
    assert broken["rule"] is None
    assert broken["findings"][0]["code"] == "KG201"


def test_what_is_no_rule_is_refused(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Invalid blocks are the caller's error; an invalid rule name is a finding."""
    with pytest.raises(UsageError, match="invalid blocks"):
        blocks_check(snapshot, settings, rule={"when": [{"block": "dance"}]})
    found = blocks_check(snapshot, settings, text="CONSTRUCT {} WHERE {}", name="No Name")
    assert (found["rule"], found["findings"][0]["code"]) == (None, "KG209")


def test_rules_at_hand_are_opened(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A rule is opened by its last name; one in another notation comes with the way to convert it."""
    found = blocks_open(snapshot, settings, name="feeds")
    assert found["rule"].name == "communication/feeds"
    assert len(found["rule"].when) == 10
    with pytest.raises(RuleError, match="SPARQL CONSTRUCT") as error:
        blocks_open(snapshot, settings, name="communication/publishes")
    assert "kg rules compile" in str(error.value.hint)
    with pytest.raises(UnknownNameError):
        blocks_open(snapshot, settings, name="communication/fed")


def test_a_trial_tells_facts_with_their_evidence(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Facts missing from the store come first, each with its premises, and nothing is written."""
    before = snapshot.count()
    found = blocks_try(snapshot, settings, rule=LISTENS, limit=5)
    assert len(found["facts"]) == 5
    assert found["whole"]
    assert found["fresh"] == found["looked"] > 20
    assert not found["recursive"]
    first = found["facts"][0]
    assert first["predicate"]["short"] == "my:listensTo"
    assert {one["predicate"]["short"] for one in first["premises"]} == {"rnkg:subscribes", "rnkg:publishes"}
    assert snapshot.count() == before


def test_a_trial_tells_what_is_known(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Facts already in the store are marked as known."""
    text = blocks_open(snapshot, settings, name="feeds")["text"]
    found = blocks_try(snapshot, settings, text=text, name="communication/feeds")
    assert found["facts"]
    assert found["fresh"] == 0
    assert all(one["known"] for one in found["facts"])


def test_a_trial_makes_examples(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The examples have the premises of a fact, and the fact; an aggregating rule has none."""
    page = blocks_try(snapshot, settings, rule=LISTENS)["examples"]
    assert page.startswith("# Who listens to whom\n")
    assert "```turtle given" in page
    assert "@prefix my: <https://example.org/wiring#> ." in page
    counting = """CONSTRUCT { ?node my:many ?n }
    WHERE { { SELECT ?node (COUNT(?t) AS ?n) WHERE { ?node rnkg:publishes ?t } GROUP BY ?node } FILTER(?n > 5) }"""
    found = blocks_try(snapshot, settings, text=f"PREFIX my: <x:>\n{counting}", name="mine/many")
    assert found["facts"]
    assert found["examples"] == ""


def test_a_rule_that_cannot_run_is_not_tried(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The error of an invalid rule is that of the check."""
    with pytest.raises(RuleError) as error:
        blocks_try(snapshot, settings, rule=_with(when=LISTENS["when"][:1]))
    assert error.value.code == "KG203"


def test_a_rule_that_reads_what_it_infers_says_so(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Only one application is shown, with a note that repetition gives more."""
    text = """CONSTRUCT { ?a rnkg:feeds ?c } WHERE { ?a rnkg:feeds ?b . ?b rnkg:feeds ?c }"""
    assert blocks_try(snapshot, settings, text=text, name="mine/far")["recursive"]
