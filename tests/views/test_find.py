"""The view of the search page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UsageError
from kg.search.options import FILTERS
from kg.views.find import choices, find

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def test_hits_have_reasons_and_evidence(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A hit has its declaration, its reasons, and their lines."""
    first = find(snapshot, settings, text="turn a laser scan into a point cloud")["hits"][0]
    assert first["node"] == "scan_filter"
    assert first["iri"].endswith("/rover_robot/scan_filter")
    assert first["evidence"]["path"].endswith("scan_filter_nodelet.cpp")
    assert first["reasons"]
    assert any(reason["evidence"] for reason in first["reasons"])


def test_filters_narrow(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """All filters must hold; several values are separated by commas; whitespace is no filter."""
    found = find(snapshot, settings, text="", publishes="PointCloud2, LaserScan", hardware=" ")
    assert [hit["node"] for hit in found["hits"]] == ["scan_filter"]
    assert found["filters"] == {"publishes": ["PointCloud2", "LaserScan"]}
    assert found["only"] == ["publisher of PointCloud2", "publisher of LaserScan"]


def test_what_words_were_taken_for(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Words that name a type or a version of ROS are reported with their interpretation."""
    found = find(snapshot, settings, text="subscribes LaserScan for ROS 1")
    assert any("LaserScan" in one for one in (*found["only"], *found["rather"]))


def test_a_need_that_nothing_fits_is_told(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The hits are the nearest ones, and the word without a match is named."""
    found = find(snapshot, settings, "RPLIDAR driver of a scanner")
    assert found["hits"]
    assert not found["fits"]
    assert found["unknown"][0].startswith("no description of a node mentions `RPLIDAR`")
    assert find(snapshot, settings, "remove far measurements from laser scans")["fits"]


def test_a_misspelt_name_is_asked_about(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An empty result suggests the nearest name."""
    assert "scan_filter" in str(find(snapshot, settings, text="scn_fliter")["advice"])


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ({}, "KG003"),
        ({"text": "a", "limit": "0"}, "KG003"),
        ({"text": "a", "limit": "101"}, "KG003"),
        ({"text": "a", "limit": "many"}, "KG003"),
        ({"text": "a", "hardwear": "lidar"}, "KG003"),
        ({"text": "a", "hardware": "flux capacitor"}, "KG702"),
        ({"text": "a", "publishes": "Nothing"}, "KG701"),
    ],
)
def test_what_cannot_be_asked(
    snapshot: EmbeddedSnapshot, settings: Settings, arguments: dict[str, str], code: str
) -> None:
    """An unknown filter or value, or an invalid limit, is an error with instructions."""
    with pytest.raises(UsageError) as caught:
        find(snapshot, settings, **arguments)
    assert caught.value.code == code
    assert caught.value.hint


def test_every_filter_has_its_choices(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The existing values are listed for each filter, sorted; each of them can be used."""
    known = choices(snapshot, settings)
    assert known.keys() == FILTERS.keys()
    assert known["package"] == sorted(known["package"]) != []
    assert all(find(snapshot, settings, package=one)["total"] for one in known["package"] if one == "rover_robot")
