"""Encoding and decoding of values, in both encodings."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.errors import RobotError
from kg.robot.messages import Types

TYPES = {1: Types(1), 2: Types(2)}
NUMBERS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "byte", "char")
BASES = (*NUMBERS, "bool", "float32", "float64", "string")
FIELD_NAMES = ("a", "b", "from", "lambda", "data", "class")


def values(kind: str) -> st.SearchStrategy[Any]:
    """Draw values of a base type."""
    if kind == "bool":
        return st.booleans()
    if kind.startswith("float"):
        return st.floats(allow_nan=False, width=32 if kind == "float32" else 64)
    if kind == "string":
        return st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=8)
    bits = int("".join(sign for sign in kind if sign.isdigit()) or 8)
    signed = kind[0] in "ib"
    return st.integers(-(1 << bits - 1), (1 << bits - 1) - 1) if signed else st.integers(0, (1 << bits) - 1)


@st.composite
def messages(draw: st.DrawFn, depth: int = 0) -> tuple[str, dict[str, Any], list[tuple[str, str]]]:
    """Draw the lines of a message, a value of it, and the definitions that it uses."""
    lines, value, used = [], {}, []
    for name in draw(st.lists(st.sampled_from(FIELD_NAMES), unique=True, max_size=4)):
        if depth < 2 and draw(st.booleans()):
            inner, one, others = draw(messages(depth + 1).filter(lambda found: bool(found[0])))
            kind = f"T{draw(st.integers(0, 10**9))}"
            used += [*others, (kind, inner)]
            drawn: st.SearchStrategy[Any] = st.just(one)
        else:
            kind = draw(st.sampled_from(BASES))
            drawn = values(kind)
        size = draw(st.sampled_from(["", "[]", "[3]"]))
        found = draw(drawn if not size else st.lists(drawn, min_size=3, max_size=3))
        value[name] = bytes(found) if size and kind in {"uint8", "char"} else found
        lines.append(f"{kind}{size} {name}")
    return "\n".join(lines), value, used


@pytest.mark.parametrize("ros", [1, 2])
@given(message=messages())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_round_trip(ros: int, message: tuple[str, dict[str, Any], list[tuple[str, str]]]) -> None:
    """Any value of any type equals its decoded bytes."""
    text, value, used = message
    types = TYPES[ros]
    if len({kind for kind, _ in used}) < len(used):
        return
    name = f"round/M{len(types.names())}"
    fresh = {kind: f"T{len(types.names())}x{index}" for index, (kind, _) in enumerate(used)}

    def renamed(lines: str) -> str:
        return "\n".join(
            f"{fresh.get(kind, kind)}{line[len(kind) :]}"
            for line in lines.splitlines()
            for kind in [line.split("[")[0].split()[0]]
        )

    parts = [f"{'=' * 80}\nMSG: round/{fresh[kind]}\n{renamed(inner)}" for kind, inner in used]
    types.define(name, "\n".join([renamed(text), *parts]))
    assert types.decode(name, types.encode(name, value)) == value


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize(
    "name", ["nav_msgs/Odometry", "sensor_msgs/PointCloud2", "tf2_msgs/TFMessage", "std_msgs/Empty"]
)
@given(content=st.binary(max_size=64), cut=st.integers(0, 900))
@settings(max_examples=40, deadline=None)
def test_any_bytes_are_a_value_or_refused(ros: int, name: str, content: bytes, cut: int) -> None:
    """Invalid bytes are rejected with KG810, whatever lengths they declare."""
    types = TYPES[ros]
    whole = types.encode(name, {})
    for bad in (content, whole[:cut] + content, whole[: max(4, cut)] + b"\xff" * 8):
        code = None
        try:
            types.decode(name, bad)
        except RobotError as error:
            code = error.code
        assert code in {None, "KG810"}


@pytest.mark.parametrize(
    ("name", "value", "field"),
    [
        ("geometry_msgs/Twist", {"linear": {"x": "fast"}}, "linear.x"),
        ("geometry_msgs/Twist", {"linear": 3}, "linear"),
        ("geometry_msgs/Twist", {"linear": {"x": 10**400}}, "linear.x"),
        ("std_msgs/UInt8", {"data": 256}, "data"),
        ("std_msgs/UInt8", {"data": 1.5}, "data"),
        ("std_msgs/UInt8", {"data": math.inf}, "data"),
        ("std_msgs/UInt8", {"data": math.nan}, "data"),
        ("std_msgs/Bool", {"data": 1}, "data"),
        ("std_msgs/String", {"data": 1}, "data"),
        ("sensor_msgs/LaserScan", {"ranges": ["1"]}, "ranges"),
        ("sensor_msgs/LaserScan", {"ranges": [[1.0]]}, "ranges"),
        ("sensor_msgs/LaserScan", {"ranges": [None]}, "ranges"),
        ("sensor_msgs/LaserScan", {"ranges": b"12"}, "ranges"),
        ("sensor_msgs/CompressedImage", {"data": [300]}, "data"),
        ("sensor_msgs/CompressedImage", {"data": [-1]}, "data"),
        ("sensor_msgs/CompressedImage", {"data": [1.5]}, "data"),
        ("nav_msgs/Odometry", {"pose": {"covariance": [0.0]}}, "pose.covariance"),
    ],
)
def test_values_that_do_not_fit(name: str, value: dict[str, Any], field: str) -> None:
    """An unsuitable value is rejected with KG805, and the message names its field."""
    for types in TYPES.values():
        with pytest.raises(RobotError) as caught:
            types.encode(name, value)
        assert caught.value.code == "KG805"
        assert f"`{field}`" in caught.value.message


@pytest.mark.parametrize("value", [{"data": "\ud800"}, {"other": 1}, {3: 1}, [], "text"])
def test_odd_values(value: Any) -> None:
    """A value other than a dict of the fields, or invalid Unicode, is rejected with KG805."""
    with pytest.raises(RobotError) as caught:
        TYPES[1].encode("std_msgs/String", value)
    assert caught.value.code == "KG805"


def test_empty_messages_have_no_fields() -> None:
    """A message without fields is an empty value, with a byte only in the encoding of ROS 2."""
    assert TYPES[1].fields("std_msgs/Empty") == ()
    assert TYPES[1].complete("std_msgs/Empty", {}) == {}
    assert TYPES[1].encode("std_msgs/Empty", {}) == b""
    assert TYPES[2].decode("std_msgs/Empty", TYPES[2].encode("std_msgs/Empty", {})) == {}
