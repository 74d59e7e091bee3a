from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.search.words import joined, name_terms, phrase, stem, terms, words

SPLIT = {
    "VoxelGrid": "voxel grid",
    "laser_scan_merger": "laser scan merger",
    "RGBDImage2": "rgbd image 2",
    "pointcloud_to_maps": "point cloud to maps",
    "XMLFile": "xml file",
    "RViz": "rviz",
    "2D lidar": "2d lidar",
    "cmd_vel": "command velocity",
    "nav2_map_server": "nav 2 map server",
}


@pytest.mark.parametrize(("name", "expected"), SPLIT.items())
def test_identifiers_are_split_into_words(name: str, expected: str) -> None:
    """Identifiers are split at signs, capitals and digits; known compounds and abbreviations too."""
    assert " ".join(words(name)).replace("rgb d", "rgbd").replace("navigation", "nav") == expected


def test_words_of_one_family_have_one_stem() -> None:
    """Detector, detection and detects are one term."""
    assert stem("detector") == stem("detection") == stem("detects")
    assert terms("scanners") == terms("scanning") == terms("scan")


@pytest.mark.parametrize(
    ("british", "american"),
    [("synchronised", "synchronized"), ("localisation", "localization"), ("colours", "color"), ("analyse", "analyze")],
)
def test_spellings_of_both_sides_of_the_ocean_have_one_stem(british: str, american: str) -> None:
    """British and American spellings are one term."""
    assert stem(british) == stem(american)


def test_words_that_tell_nothing_are_left_out() -> None:
    """Grammatical words and those of every node are not terms, but count in phrases."""
    assert terms("a node that publishes the robot's topic") == terms("publishes robot")
    assert len(phrase("body of the robot")) == 4


def test_what_a_name_is_without_is_no_term_of_it() -> None:
    """A name that contains `NoKinect` is not found by kinect."""
    assert "kinect" not in name_terms("individualMarkersNoKinect")
    assert "kinect" in name_terms("individualMarkersKinect")


@pytest.mark.parametrize(
    ("name", "expected"),
    [("InfluxDB", ["influxdb"]), ("Wi-Fi signal", ["wifi"]), ("laser scan", []), ("voxel_grid", [])],
)
def test_names_of_several_words_are_one_word_too(name: str, expected: list[str]) -> None:
    """Words that may be written as one are found by both spellings."""
    assert list(joined(name)) == expected
    assert set(expected) <= set(terms(name))


@given(st.text())
def test_any_text_has_terms(text: str) -> None:
    """Terms are in lower case and deterministic."""
    found = terms(text)
    assert found == terms(text)
    assert all(term == term.lower() for term in found)
