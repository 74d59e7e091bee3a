"""The views of the pages of rules."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kg.errors import UnknownNameError
from kg.views.rules import rule, rule_feeds, rule_index, rules

if TYPE_CHECKING:
    from pathlib import Path

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def test_rules_stand_in_families(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Every rule is in its family with its documentation, and with its cost in the last full run."""
    found = rules(snapshot, settings)
    families = {one["family"]: one for one in found["families"]}
    assert families["communication"]["in_force"]
    assert not families["owl-rl"]["in_force"]
    feeds = next(one for one in families["communication"]["rules"] if one["rule"] == "communication/feeds")
    assert "What it infers" in feeds["sections"]
    assert feeds["derived"] > 0
    assert feeds["seconds"] >= 0
    assert found["problems"] == []


def test_the_last_run_is_told(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The number of inferred triples, and of productive rules."""
    run = rules(snapshot, settings)["run"]
    assert run["inferred"] > 1000
    assert 0 < run["fired"] < run["ran"]
    assert run["ended"] >= run["started"]


def test_edges_lead_from_writers_to_readers(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A rule has edges from the rules that derive its input, labelled with the terms."""
    edges = rules(snapshot, settings)["graph"]["edges"]
    edge = next(one for one in edges if one["to"] == "communication/feeds" and one["from"].endswith("agrees-on-topic"))
    assert edge["terms"] == ["rnkg:agreesWith"]
    assert not edge["absent"]


def test_a_rule_has_its_text_and_triples(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A rule is found by its last name; its inferred triples have the terms accepted by `why`."""
    found = rule(snapshot, settings, name="feeds")
    assert found["rule"] == "communication/feeds"
    assert "CONSTRUCT" in found["text"]
    assert found["place"]["path"] == "communication/feeds.rq"
    assert found["found"] == [{"kind": "rnkg:feeds", "triples": len(found["inferred"])}]
    assert found["inferred"][0]["predicate"] == "<https://w3id.org/rnkg/ns#feeds>"
    assert found["inferred"][0]["labels"][1] == "rnkg:feeds"
    assert "communication/feeds" in {one["rule"] for one in found["around"]["nodes"]}


def test_classes_are_kinds_of_triples(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A rule that assigns a class derives triples of that class, and these are counted."""
    found = rule(snapshot, settings, name="communication/topic-communication")
    kinds = {one["kind"]: one["triples"] for one in found["found"]}
    assert any(kind.startswith("a ") and number for kind, number in kinds.items())


def test_an_unknown_rule(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An unknown rule gets a suggestion."""
    with pytest.raises(UnknownNameError) as caught:
        rule(snapshot, settings, name="communication/fed")
    assert "communication/feeds" in str(caught.value.hint)


def test_a_broken_rule_hides_no_other(snapshot: EmbeddedSnapshot, settings: Settings, tmp_path: Path) -> None:
    """The problem of a user rule is reported next to it, and the others are listed."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "broken.rq").write_text("# Broken\nCONSTRUCT { ?a ?b } WHERE", "utf-8")
    found = rules(snapshot, replace(settings, rules=(tmp_path,)))
    mine = next(one for one in found["families"] if one["family"] == "mine")
    assert mine["rules"][0]["error"]["code"].startswith("KG2")
    assert found["problems"]
    assert len(found["families"]) > 5


def test_the_index_counts_what_families_have(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The counts of the index are those of the rules, which it returns only for a family or words."""
    found, every = rule_index(snapshot, settings), rules(snapshot, settings)
    assert found["rules"] == []
    assert found["run"] == every["run"]
    for one, other in zip(found["families"], every["families"], strict=True):
        assert (one["family"], one["rules"]) == (other["family"], len(other["rules"]))
        assert one["report"] == sum(1 for rule in other["rules"] if rule["severity"])
        assert (one["derived"] or 0) == sum(rule["derived"] or 0 for rule in other["rules"])


def test_the_index_selects_by_family_and_words(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """All words must be in the name, title or documentation; without a family those of all families are returned."""
    found = [one["rule"] for one in rule_index(snapshot, settings, text="FEEDS subscribers")["rules"]]
    assert "communication/feeds" in found
    within = [one["rule"] for one in rule_index(snapshot, settings, family="communication", text="feeds")["rules"]]
    assert "communication/feeds" in within
    assert all(name.startswith("communication/") for name in within)
    with pytest.raises(UnknownNameError) as caught:
        rule_index(snapshot, settings, family="comunication")
    assert "communication" in str(caught.value.hint)


def test_the_index_reports_broken_rules(snapshot: EmbeddedSnapshot, settings: Settings, tmp_path: Path) -> None:
    """A rule that cannot be read is a problem of the index, and the error is next to it in its family."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "broken.rq").write_text("# Broken\nCONSTRUCT { ?a ?b } WHERE", "utf-8")
    changed = replace(settings, rules=(tmp_path,))
    found = rule_index(snapshot, changed, family="mine")
    assert found["problems"] == rule_feeds(snapshot, changed)["problems"] != []
    assert found["rules"][0]["error"]["code"].startswith("KG2")


def test_equal_rules_of_another_folder_have_their_own_places(
    snapshot: EmbeddedSnapshot, settings: Settings, tmp_path: Path
) -> None:
    """Rules are cached by their content and their folders: an error names the file that is in force."""
    for name in ("first", "second"):
        (tmp_path / name / "mine").mkdir(parents=True)
        (tmp_path / name / "mine" / "broken.rq").write_text("# Broken\nCONSTRUCT { ?a ?b } WHERE", "utf-8")
        (problem,) = rule_feeds(snapshot, replace(settings, rules=(tmp_path / name,)))["problems"]
        assert str(tmp_path / name) in problem
