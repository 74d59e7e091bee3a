from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from search.compose.chaining import answer_of, node, store_of

from kg.errors import Exit, UnknownNameError

if TYPE_CHECKING:
    from pathlib import Path

SCAN, GRID, TWIST = "sensor_msgs/LaserScan", "nav_msgs/OccupancyGrid", "geometry_msgs/Twist"


def test_without_a_chain_it_says_how_far_one_gets(tmp_path: Path) -> None:
    """KG706 lists the types that can be reached, the longest path, and the types that lead to the target."""
    store = store_of(
        tmp_path / "store",
        node("mapper", {"scan": SCAN}, {"map": GRID}),
        node("planner", {"map": GRID}, {"path": "nav_msgs/Path"}),
        node("teleop", {"joy": "sensor_msgs/Joy"}, {"cmd_vel": TWIST}),
    )
    with pytest.raises(UnknownNameError, match=r"no chain of at most 4 nodes turns") as caught:
        answer_of(store, "LaserScan", "Twist")
    hint = caught.value.hint or ""
    assert caught.value.code == "KG706"
    assert caught.value.exit_code is Exit.FOUND
    assert f"{SCAN} becomes nav_msgs/OccupancyGrid, nav_msgs/Path." in hint
    assert f"{SCAN} -> robots/mapper -> {GRID} -> robots/planner -> nav_msgs/Path" in hint
    assert f"{TWIST} is made of sensor_msgs/Joy." in hint


def test_it_says_which_types_nobody_takes_or_gives(tmp_path: Path) -> None:
    """A type that is only published cannot begin a chain; similar types that can are suggested."""
    store = store_of(
        tmp_path / "store",
        node("driver", {"multi_scan": "sensor_msgs/MultiEchoLaserScan"}, {"scan": SCAN}),
        node("teleop", {"joy": "sensor_msgs/Joy"}, {"cmd_vel": TWIST}),
    )
    with pytest.raises(UnknownNameError) as caught:
        answer_of(store, "LaserScan", "Twist")
    hint = caught.value.hint or ""
    assert "No node that can be started subscribes sensor_msgs/LaserScan." in hint
    assert "`sensor_msgs/MultiEchoLaserScan`" in hint


def test_an_empty_store_has_no_types(tmp_path: Path) -> None:
    """In an empty store, the type is unknown."""
    with pytest.raises(UnknownNameError) as caught:
        answer_of(store_of(tmp_path / "store"), "LaserScan", "Twist")
    assert caught.value.code == "KG705"
