from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import RobotError
from kg.robot.driving.paths import Call, Each, Element, Field, Path, look, parse, put, type_at
from kg.robot.messages import Types

names = st.from_regex(r"[a-z_][a-z0-9_]{0,6}", fullmatch=True)
numbers = st.floats(allow_nan=False, allow_infinity=False)


def _deeper(inner: st.SearchStrategy[Path]) -> st.SearchStrategy[Path]:
    return st.one_of(
        st.builds(Field, inner, names),
        st.builds(Each, inner),
        st.builds(Element, inner, st.integers(-99, 99)),
        st.builds(Call, names, st.lists(st.one_of(inner, numbers), min_size=1, max_size=3).map(tuple)),
    )


paths: st.SearchStrategy[Path] = st.recursive(st.builds(Field, st.none(), names), _deeper, max_leaves=8)


@given(paths)
def test_a_path_is_read_as_it_is_written(path: Path) -> None:
    """The text of a path parses to the path, and is the same when written again."""
    try:
        again = parse(str(path))
    except RobotError as error:
        assert "functions in each other" in error.message  # noqa: PT017 - the one limit that a path may exceed
        return
    assert again == path
    assert str(again) == str(path)


@given(st.text(alphabet="ab._[]()0123,-e \n", max_size=30))
def test_any_text_is_a_path_or_an_error(text: str) -> None:
    """Any text is a path with an equivalent text, or KG826."""
    try:
        path = parse(text)
    except RobotError as error:
        assert error.code == "KG826"  # noqa: PT017 - either is right
    else:
        assert parse(str(path)) == path


@pytest.mark.parametrize(
    "text", ["", ".x", "x.", "x[", "x[1.5]", "f(", "f()", "f(x", "x y", "3", "x..y", "f(x,)", "é", "(" * 99, "a(" * 99]
)
def test_what_is_no_path_is_refused(text: str) -> None:
    """An invalid path is KG826."""
    with pytest.raises(RobotError) as refused:
        parse(text)
    assert refused.value.code == "KG826"


ROW = {
    "header": {"frame_id": "map"},
    "markers": [
        {"id": 7, "pose": {"x": 3.0, "y": 4.0, "z": 0.0}, "corners": [1, 2]},
        {"id": 9, "pose": {"x": 0.0, "y": 1.0, "z": 0.0}, "corners": [3]},
    ],
    "ranges": [0.05, 2.0, math.inf, math.nan, 1.5, 9.0, 3.0, 4.0],
    "angle_min": 0.0,
    "angle_increment": math.pi / 4,
    "range_min": 0.1,
    "range_max": 5.0,
    "empty": [],
    "turn": {"x": 0.0, "y": 0.0, "z": math.sin(0.25), "w": math.cos(0.25)},
    "battery": 55.0,
    "bad": math.nan,
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("header.frame_id", "map"),
        ("markers[].id", [7, 9]),
        ("markers[1].id", 9),
        ("markers[-1].id", 9),
        ("markers[5].id", None),
        ("markers[].corners[]", [1, 2, 3]),
        ("markers[].corners[0]", [1, 3]),
        ("count(markers)", 2),
        ("count(empty)", 0),
        ("first(markers).id", 7),
        ("first(markers[].pose.x)", 3.0),
        ("first(empty)", None),
        ("first(empty).id", None),
        ("distance(first(markers[].pose))", 5.0),
        ("distance(first(empty))", None),
        ("nearest(markers,pose).id", 9),
        ("nearest(empty,pose).id", None),
        ("maximum(markers[].corners)", 3),
        ("minimum(ranges)", 1.5),
        ("minimum(empty)", None),
        ("at(ranges,0)", None),
        ("at(ranges,0.7854)", 2.0),
        ("at(ranges,1.5708)", math.inf),
        ("at(ranges,2.3562)", None),
        ("at(ranges,-1.5708)", 3.0),
        ("at(ranges,-1.5708,1.6)", 3.0),
        ("at(ranges,-0.7854)", 4.0),
        ("at(empty,0)", None),
        ("scaled(battery,0.01)", 0.55),
        ("bad", None),
        ("missing.field", None),
        ("yaw(missing)", None),
    ],
)
def test_what_is_at_a_path(text: str, expected: object) -> None:
    """A path leads to its value; missing values and NaN are None; invalid readings are skipped."""
    found = look(parse(text), ROW)
    assert found == (pytest.approx(expected) if isinstance(expected, float) else expected)


def test_scans_from_minus_pi() -> None:
    """A scan starting behind the robot is read at the same angles; uncovered angles give no value."""
    step = math.pi / 2
    scan = {"ranges": [4.0, 3.0, 1.0, 2.0], "angle_min": -math.pi, "angle_increment": step, "range_max": 10.0}
    for text, expected in (("0", 1.0), ("1.5708", 2.0), ("-1.5708", 3.0), ("3.14159", 4.0)):
        assert look(parse(f"at(ranges,{text})"), scan) == expected
    half = {"ranges": [3.0, 1.0, 2.0], "angle_min": -step, "angle_increment": step, "range_max": 10.0}
    assert look(parse("at(ranges,0)"), half) == 1.0
    assert look(parse("at(ranges,3.14159)"), half) is None


@given(st.floats(-math.pi + 1e-6, math.pi - 1e-6))
def test_a_heading_is_read_as_it_was_put(heading: float) -> None:
    """`yaw` writes a unit quaternion, and reads the heading back."""
    message: dict[str, dict[str, dict[str, float]]] = {}
    put(parse("yaw(pose.orientation)"), message, heading)
    turned = message["pose"]["orientation"]
    assert math.hypot(*turned.values()) == pytest.approx(1)
    assert look(parse("yaw(pose.orientation)"), message) == pytest.approx(heading)


@given(
    st.floats(-1e300, 1e300),
    st.sampled_from([0.01, 1000.0, -1.0]),
    st.lists(names, min_size=1, max_size=4, unique=True),
)
def test_a_number_is_read_as_it_was_put(number: float, factor: float, steps: list[str]) -> None:
    """A field, scaled or not, is read as it was written, wherever it is."""
    for text in (".".join(steps), f"scaled({'.'.join(steps)},{factor})"):
        message: dict[str, object] = {}
        put(parse(text), message, number)
        assert look(parse(text), message) == pytest.approx(number, rel=1e-9, abs=1e-300)


@pytest.mark.parametrize("text", ["minimum(ranges)", "markers[].id", "markers[0]", "markers[-1].id", "at(ranges,0)"])
def test_what_only_reads_is_not_put(text: str) -> None:
    """Writing to a path that is not a single field is KG826."""
    with pytest.raises(RobotError) as refused:
        put(parse(text), {}, 1.0)
    assert refused.value.code == "KG826"


@pytest.mark.parametrize("text", ["yaw(battery)", "distance(header)", "count(battery)", "scaled(header,2)"])
def test_a_function_of_another_kind_of_field(text: str) -> None:
    """A function applied to an unsuitable field is KG826, not a crash."""
    with pytest.raises(RobotError) as refused:
        look(parse(text), ROW)
    assert refused.value.code == "KG826"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("pose.pose.position.q", "no field `q`"),
        ("pose.pose.positon.x", "no field `positon`"),
        ("yaw(pose.pose.orientation,1)", "2 arguments"),
        ("jaw(pose.pose.orientation)", "unknown function"),
        ("child_frame_id.x.y", "`child_frame_id` has no fields"),
        ("pose.covariance[3]", None),
        ("header.stamp.nanosec", None),
        ("nearest(pose.pose,position).position.x", None),
        ("nearest(pose.pose,place).x", "no field `place`"),
    ],
)
def test_paths_are_checked_against_the_type(text: str, says: str | None) -> None:
    """An unknown field of the message type is reported before any message arrives."""
    types = Types(1)
    if says is None:
        type_at(parse(text), types, "nav_msgs/Odometry")
        return
    with pytest.raises(RobotError) as refused:
        type_at(parse(text), types, "nav_msgs/Odometry")
    assert refused.value.code == "KG826"
    assert says in refused.value.message


def test_an_element_is_made_on_the_way_to_a_field() -> None:
    """Missing elements are created up to the index; fields of one element share it."""
    message: dict[str, Any] = {}
    put(parse("points[0].positions"), message, [1.0])
    put(parse("points[0].time.sec"), message, 2)
    put(parse("points[1].positions"), message, [3.0])
    assert message == {"points": [{"positions": [1.0], "time": {"sec": 2}}, {"positions": [3.0]}]}
