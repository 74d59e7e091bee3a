"""Things by their names, of all lists."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.views.named import named

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


@pytest.mark.parametrize(
    ("text", "of", "name"),
    [
        ("rover_core", "packages", "rover_core"),
        ("scan_filter", "nodes", "scan_filter"),
        ("/scan_filtered", "topics", "/scan_filtered"),
        ("SCAN_FILTERED", "topics", "/scan_filtered"),
        ("laserscan", "types", "sensor_msgs/LaserScan"),
        ("laser scanner", "hardware", "laser scanner"),
        ("drone.launch.py", "systems", "rover_bringup/launch/drone.launch.py"),
    ],
)
def test_a_name_leads_to_its_thing(
    snapshot: EmbeddedSnapshot, settings: Settings, text: str, of: str, name: str
) -> None:
    """A whole name, or its last segment, gives the thing first, whatever the case."""
    first = named(snapshot, settings, text=text)["names"][0]
    assert (first["of"], first["name"].partition("/launch/")[2] or first["name"]) == (
        of,
        name.partition("/launch/")[2] or name,
    )


def test_parts_of_names_fit_after_whole_ones(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Names that begin with the text come before those that contain it, and each name is there once a list."""
    found = named(snapshot, settings, text="scan", limit="100")
    keys = [(one["of"], one["name"]) for one in found["names"]]
    assert len(keys) == len(set(keys)) == found["total"] > 5
    starts = [one["name"].lower().rpartition("/")[2].startswith("scan") for one in found["names"]]
    assert starts.index(False) > 2
    assert all("scan" in name.lower() for _, name in keys)


def test_sentences_and_letters_are_not_names(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A need in words and a single letter give no names."""
    for text in ("s", "drive to a goal and avoid obstacles", "zzzzzz"):
        assert named(snapshot, settings, text=text)["names"] == []
