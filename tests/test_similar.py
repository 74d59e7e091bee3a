"""Tests of suggestions for misspelt names."""

from __future__ import annotations

import pytest

from kg.similar import did_you_mean, similar

KNOWN = ["move_base", "husky_node", "husky_base/husky_node", "amcl", "/scan", "/scan_raw"]


@pytest.mark.parametrize(
    ("typed", "first"),
    [
        ("move_bas", "move_base"),
        ("Move_Base", "move_base"),
        ("AMCL2", "amcl"),
        ("scan", "/scan"),
        ("base", "move_base"),
    ],
)
def test_similar(typed: str, first: str) -> None:
    """Slips, other case and parts of names are recognised."""
    assert similar(typed, KNOWN)[0] == first


def test_sentence() -> None:
    """The question lists the candidates; a name like no other gives no question."""
    assert did_you_mean("/scan_rwa", KNOWN) == "Did you mean `/scan_raw` or `/scan`?"
    assert did_you_mean("zzzzzz", KNOWN) is None


def test_many_names_give_the_same_as_few() -> None:
    """The similar names are found among thousands of others."""
    others = [f"/other_{number}/thing" for number in range(5000)]
    for typed in ("move_bas", "/scan_rwa", "base", "Move_Base"):
        assert similar(typed, [*KNOWN, *others]) == similar(typed, KNOWN)


def test_the_exact_name_in_another_case_is_found_among_many() -> None:
    """The nearest of many similar names is first."""
    assert similar("/ROBOT_17/scan", [f"/robot_{number}/scan" for number in range(5000)])[0] == "/robot_17/scan"
