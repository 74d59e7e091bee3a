from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, Final

import pytest
from hypothesis import given
from hypothesis import strategies as st
from search.store import CONTENT

from kg.search.index import build
from kg.search.names import Names
from kg.search.needs import parse

INDEX: Final = build(CONTENT)
NAMES: Final = Names(INDEX.features.names, INDEX.concepts, INDEX.text.names)
CASES: Final = tomllib.loads((Path(__file__).parent / "cases" / "needs.toml").read_text("utf-8"))["case"]
PIECES: Final = [
    "subscribes",
    "LaserScan",
    "for",
    "ros",
    "2",
    ",",
    ";",
    "licensed",
    "under",
    "BSD",
    "instead",
    "of",
    "so",
    "that",
    "turn",
    "into",
    "one",
    "GPS",
    "a/B::C",
    "\x00",
    "é",
    "点",
    "publish",
    "as",
    "to",
    "used",
    "by",
    "replace",
    "with",
    "without",
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["text"] or "nothing")
def test_filters_and_preferences_are_understood(case: dict[str, Any]) -> None:
    """A text has the filters and preferences of its case, and no other filters."""
    wishes = parse(case["text"], NAMES).wishes
    strict = {feature.replace(":", " ", 1) for wish in wishes if wish.strict for feature in wish.features}
    rather = {feature.replace(":", " ", 1) for wish in wishes if not wish.strict for feature in wish.features}
    assert strict == set(case.get("strict", ()))
    assert set(case.get("rather", ())) <= rather


def test_what_is_told_beside_the_point_counts_less() -> None:
    """Words of a purpose, or of something excluded, weigh less than those of the node itself."""
    weights = {one.text: one.weight for one in parse("make a merged scan of lasers for navigation", NAMES).wordings}
    assert weights["navigation"] < weights["scan"] == 1
    asides = {one.text: one.aside for one in parse("remove points on a floor before mapping", NAMES).wordings}
    assert asides == {"remove": False, "points": False, "floor": False, "mapping": True}
    weights = {one.text: one.weight for one in parse("replace encoders by a camera", NAMES).wordings}
    assert weights["encoders"] < weights["camera"] == 1


def test_the_object_of_for_at_the_beginning_is_no_purpose() -> None:
    """`driver for a camera` is about cameras."""
    assert all(wording.weight == 1 for wording in parse("driver for a camera", NAMES).wordings)


def test_synonyms_stand_beside_what_was_typed() -> None:
    """A word adds the labels of the concept that it names, with less weight."""
    (wording,) = parse("lidar", NAMES).wordings
    assert ("laser", "scan") in {one.terms for one in wording.alternatives[1:]}
    (wording,) = parse("GPS", NAMES).wordings
    assert ("gnss",) in {one.terms for one in wording.alternatives[1:]}
    assert all(one.weight < 1 for one in wording.alternatives[1:])


def test_everyday_words_stand_for_terms_and_not_the_reverse() -> None:
    """Whoever says `crash into` wants collisions; whoever says `collision` said it all."""
    said = {one.text: {other.terms for other in one.alternatives} for one in parse("crash into a wall", NAMES).wordings}
    assert {("collid",), ("obstacl",)} <= said["crash"]
    terms = {other.terms for one in parse("collision", NAMES).wordings for other in one.alternatives}
    assert ("crash",) not in terms


def test_a_phrase_of_small_words_can_stand_for_a_term() -> None:
    """`where it is` has no word to search for, but a meaning."""
    (wording,) = parse("where it is", NAMES).wordings
    assert wording.text == "where it is"
    assert ("pose",) in {one.terms for one in wording.alternatives}
    assert parse("what it is", NAMES).wordings == ()


def test_words_that_no_node_knows_are_named() -> None:
    """They are listed as typed, with the spellings searched instead, if any."""
    need = parse("RPLIDAR driver for a camra", NAMES)
    assert need.unknown == ("RPLIDAR", "camra")
    assert {one.text: one.near for one in need.wordings}["camra"] == ("camera",)
    assert {one.text: one.name for one in need.wordings} == {"RPLIDAR": True, "driver": False, "camra": False}


def test_capitals_make_a_name_of_a_word_of_grammar() -> None:
    """CAN is a bus, can a verb."""
    assert "CAN" in parse("CAN frames to scans", NAMES).unknown
    assert not parse("it can merge", NAMES).unknown


@given(st.one_of(st.text(), st.lists(st.sampled_from(PIECES), max_size=12).map(" ".join)))
def test_any_text_is_a_need(text: str) -> None:
    """No text is refused, and parsing is deterministic."""
    need = parse(text, NAMES)
    assert need == parse(text, NAMES)
    assert all(wording.alternatives[0].terms for wording in need.wordings)
