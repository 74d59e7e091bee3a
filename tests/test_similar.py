"""Tests of names typed almost right."""

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
    """The question names the candidates; there is none for a name like no other."""
    assert did_you_mean("/scan_rwa", KNOWN) == "Did you mean `/scan_raw` or `/scan`?"
    assert did_you_mean("zzzzzz", KNOWN) is None
