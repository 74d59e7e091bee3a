from __future__ import annotations

import pytest

from kg.cli.usage import did_you_mean


@pytest.mark.parametrize(
    ("name", "names", "words"),
    [
        ("move_bsae", ["move_base", "amcl"], "did you mean `move_base`?"),
        ("MOVE_BASE", ["move_base"], "did you mean `move_base`?"),
        ("camera", ["left_camera_driver_node"], "did you mean `left_camera_driver_node`?"),
        ("zz", ["puzzle"], None),
        ("anything", [], None),
    ],
)
def test_near_names_are_suggested(name: str, names: list[str], words: str | None) -> None:
    """Typing errors, other case and parts of names find their name; short parts do not."""
    assert did_you_mean(name, names) == words
