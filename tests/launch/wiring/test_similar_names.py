"""Similar names that are probably the same one, and distinct names."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.launch.wiring.similar_names import Alike, Related, alike, alike_when_short, related

_WORD = st.sampled_from(["scan", "camera", "cameras", "velocity", "velocty", "min", "cmd", "Odom", "odom", "x1", "x2"])
_SEGMENT = (
    st.builds("".join, st.lists(st.sampled_from(["scan", "cmd_vel", "_", "-", "image", "s"]), max_size=3)) | _WORD
)
_NAME = st.lists(_SEGMENT, min_size=1, max_size=3).map(lambda parts: "/" + "/".join(parts))

SAME = [
    ("/scan", "/front/scan"),
    ("/robot/cmd_vel", "/cmd_vel"),
    ("/image_color", "/image_colour"),
    ("/trajectory", "/trajetcory"),
    ("/velocity_controller/odom", "/velocty_controller/odom"),
    ("/goal", "/goals"),
    ("/Scan", "/scan"),
    ("/imuData", "/imu_data"),
    ("/imu-data", "/imu_data"),
    ("/cmdvel", "/cmd_vel"),
]
OTHERS = [
    ("/camera1/image", "/camera2/image"),
    ("/min_range", "/max_range"),
    ("/x_pos", "/y_pos"),
    ("/increase", "/decrease"),
    ("/joint_a", "/joint_b"),
    ("/tf", "/tf2"),
    ("/left/scan", "/right/scan"),
    ("/scan", "/scan_raw"),
    ("/camera/{}", "/camera/image"),
    ("/internal_state", "/external_state"),
]


MORE = [
    ("/imu/data", "/imu/data_compass"),
    ("/imu_filtered/data", "/imu/data"),
    ("/narrow_scan", "/scan"),
    ("/camera/depth/image_raw", "/camera/depth_registered/image_raw"),
    ("/detection/object_tracker/objects", "/detection/objects"),
    ("/a_opponent_controller/path", "/a_controller/path"),
    ("/camera/left/image_raw", "/left_camera/image_raw"),
]
NO_MORE = [("/scan_1", "/scan"), ("/camera/image_raw", "/camera/image_rect"), ("/a/b/c", "/c/d"), ("/x", "/x")]


@pytest.mark.parametrize(("one", "other"), MORE)
def test_names_with_more_to_them_are_related(one: str, other: str) -> None:
    """One or two additional words in a segment, an additional namespace, or another order of words."""
    assert related(one, other)
    assert Related([one]).find(other) == [one]
    assert Related([other]).find(one) == [other]


@pytest.mark.parametrize(("one", "other"), NO_MORE)
def test_numbers_and_other_words_relate_nothing(one: str, other: str) -> None:
    """Numbered, replaced and equal names are not extensions."""
    assert not related(one, other)
    assert Related([one]).find(other) == []


@pytest.mark.parametrize(("one", "other"), SAME)
def test_slips_namespaces_plurals_case_and_separators_are_seen_through(one: str, other: str) -> None:
    """These pairs are probably one name, in either direction."""
    assert alike(one, other)
    assert Alike([one]).find(other) == [one]
    assert Alike([other]).find(one) == [other]


@pytest.mark.parametrize(("one", "other"), OTHERS)
def test_what_differs_on_purpose_is_told_apart(one: str, other: str) -> None:
    """Numbers, short words, other first letters and additional words make another name."""
    assert not alike(one, other)
    assert Alike([one]).find(other) == []


@given(_NAME, _NAME)
def test_likeness_is_mutual_and_never_of_a_name_with_itself(one: str, other: str) -> None:
    """The relation is symmetric and irreflexive."""
    assert alike(one, other) == alike(other, one)
    assert not alike(one, one)


@given(st.lists(_NAME, max_size=12), _NAME)
def test_the_index_finds_exactly_what_comparing_all_would(names: list[str], asked: str) -> None:
    """The index keys miss no candidate."""
    assert Alike(names).find(asked) == sorted({name for name in names if alike(name, asked)})


@given(st.lists(_NAME, max_size=8), _NAME)
def test_the_index_of_related_names_finds_what_comparing_all_would(names: list[str], asked: str) -> None:
    """Related names are found from either of them."""
    assert Related(names).find(asked) == sorted({name for name in names if related(name, asked) and name != asked})


@given(st.text(max_size=20), st.text(max_size=20))
def test_odd_names_can_be_compared(one: str, other: str) -> None:
    """Any text can be compared."""
    assert alike(one, other) == alike(other, one)
    assert other not in Alike([one, other]).find(other)


@pytest.mark.parametrize(("one", "other"), [("/cmd_vell", "/cmd_vel"), ("/cmd_vle", "/cmd_vel"), ("/a/odo", "/a/odom")])
def test_short_words_are_alike_where_one_of_them_is_wrong(one: str, other: str) -> None:
    """A letter added, missing, or swapped; without other evidence such names are both intended."""
    assert alike_when_short(one, other)
    assert not alike(one, other)


@pytest.mark.parametrize(
    ("one", "other"),
    [("/min_x", "/max_x"), ("/x_pos", "/y_pos"), ("/tf", "/tf2"), ("/in", "/inn"), ("/a/b", "/a"), ("/a", "/a")],
)
def test_short_words_that_mean_something_else(one: str, other: str) -> None:
    """Other letters, numbers, very short words."""
    assert not alike_when_short(one, other)
