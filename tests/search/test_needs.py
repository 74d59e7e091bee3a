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
NAMES: Final = Names(INDEX.features.names, INDEX.concepts)
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
    """A text gives the filters and preferences that its case names, and no other filters."""
    wishes = parse(case["text"], NAMES).wishes
    strict = {feature.replace(":", " ", 1) for wish in wishes if wish.strict for feature in wish.features}
    rather = {feature.replace(":", " ", 1) for wish in wishes if not wish.strict for feature in wish.features}
    assert strict == set(case.get("strict", ()))
    assert set(case.get("rather", ())) <= rather


def test_what_is_told_beside_the_point_counts_less() -> None:
    """Words of a purpose, and of what is not wanted, weigh less than those of the node itself."""
    weights = {one.text: one.weight for one in parse("make a merged scan of lasers for navigation", NAMES).wordings}
    assert weights["navigation"] < weights["scan"] == 1
    weights = {one.text: one.weight for one in parse("replace encoders by a camera", NAMES).wordings}
    assert weights["encoders"] < weights["camera"] == 1


def test_the_object_of_for_at_the_beginning_is_no_purpose() -> None:
    """`driver for a camera` is about cameras."""
    assert all(wording.weight == 1 for wording in parse("driver for a camera", NAMES).wordings)


def test_synonyms_stand_beside_what_was_typed() -> None:
    """A phrase brings the phrases of its group, which weigh less than itself."""
    (wording,) = parse("GPS", NAMES).wordings
    first, *others = wording.alternatives
    assert first.terms == ("gps",)
    assert {one.terms for one in others} >= {("gnss",), ("nav", "sat")} or ("navig", "sat") in {
        one.terms for one in others
    }
    assert all(one.weight < first.weight for one in others)


@given(st.one_of(st.text(), st.lists(st.sampled_from(PIECES), max_size=12).map(" ".join)))
def test_any_text_is_a_need(text: str) -> None:
    """No text is refused, and the same text is understood the same way each time."""
    need = parse(text, NAMES)
    assert need == parse(text, NAMES)
    assert all(wording.alternatives[0].terms for wording in need.wordings)
