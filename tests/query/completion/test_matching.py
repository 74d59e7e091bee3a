from __future__ import annotations

import pytest

from kg.query.completion.service import matcher


@pytest.mark.parametrize(
    ("typed", "name", "score"),
    [
        ("", "anything", 1),
        ("scan", "scan", 0),
        ("Scan", "scan_filter", 1),
        ("cmd_vel", "/robot1/cmd_vel", 2),
        ("publisher", "hasPublisher", 2),
        ("ish", "publishes", 3),
        ("hpub", "hasPublisher", 4),
        ("hdc", "hasDependencyCount", 4),
        ("x", "publishes", None),
        ("zz", "publishes", None),
    ],
)
def test_how_well_a_name_fits(typed: str, name: str, score: int | None) -> None:
    """A name matches as a whole, by its beginning, by that of a part, by a part, or by its letters in order."""
    assert matcher(typed)(name) == score
