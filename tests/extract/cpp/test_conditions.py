"""Preprocessor conditions in packages of ROS 1 and ROS 2."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.cpp.conditions import Macros, holds

ATOMS = {
    "ROS_VERSION == 2": (False, True),
    "defined(USE_ROS1)": (True, False),
    "EXTRA": (None, None),
    "0": (False,) * 2,
}


@pytest.mark.parametrize(
    ("directive", "in_ros1", "in_ros2"),
    [
        ("#if ROS_AVAILABLE == 1", True, False),
        ("#  elif ROS_AVAILABLE == 2 // with rclcpp", False, True),
        ("#if defined __ROS_VERSION && __ROS_VERSION > 1", False, True),
        ("#ifdef BUILDING_ROS1", True, False),
        ("#ifndef BUILDING_ROS1", False, True),
        ("#if !(defined(USE_ROS2))", True, False),
        ("#if WITH_EXTRAS && ROS_VERSION == 1", None, False),
        ("#if WITH_EXTRAS || ROS_VERSION == 1", True, None),
        ("#if ROS_VERSION == 1 || \\\n  ROS_VERSION == 2", True, True),
        ("#if 0 /* never */", False, False),
        ("#else", True, True),
        ("#ifdef WITH_EXTRAS", None, None),
        ("#if ROS_VERSION_MINIMUM(1, 14, 0)", None, None),
        ("#if ROS_VERSION >= ROS_VERSION_COMBINED(1, 14, 0)", None, None),
        ("#ifndef NODE_FOR_ROS2_H", None, None),
    ],
)
def test_conditions_about_the_version_are_decided(
    directive: str, *, in_ros1: bool | None, in_ros2: bool | None
) -> None:
    """A condition holds, fails, or is unknown."""
    assert holds(directive.encode(), Macros(1)) is in_ros1
    assert holds(directive.encode(), Macros(2)) is in_ros2


def test_what_the_file_defines_is_left_alone() -> None:
    """A header guard resembles a version flag, and is defined in the file."""
    assert holds(b"#ifndef FILTER_ROS2", Macros(2, frozenset({b"FILTER_ROS2"}))) is None


@pytest.mark.parametrize(
    ("directive", "truth"),
    [
        ("#if PARENT == PLAIN", True),
        ("#elif PARENT == MANAGED", False),
        ("#ifdef PARENT", True),
        ("#if defined(GONE)", False),
        ("#if BRACKETS", True),
        ("#if EMPTY", None),
        ("#ifdef EMPTY", True),
        ("#if LOOP", None),
    ],
)
def test_macros_of_the_file_decide_conditions(directive: str, *, truth: bool | None) -> None:
    """A macro expands to a number, another macro, or nothing, or is undefined."""
    texts = {b"PLAIN": b"1", b"MANAGED": b"2", b"PARENT": b"PLAIN", b"GONE": None, b"BRACKETS": b"(1)", b"EMPTY": b""}
    assert holds(directive.encode(), Macros(2, texts=texts | {b"LOOP": b"LOOP"})) is truth


def _truth(condition: object, ros: int) -> bool | None:
    if isinstance(condition, str):
        return ATOMS[condition][ros - 1]
    assert isinstance(condition, tuple)
    kind, *parts = condition
    known = [_truth(part, ros) for part in parts]
    if kind == "!":
        return None if known[0] is None else not known[0]
    decisive = kind == "||"
    return decisive if decisive in known else None if None in known else not decisive


def _written(condition: object) -> str:
    if isinstance(condition, str):
        return condition
    assert isinstance(condition, tuple)
    kind, *parts = condition
    texts = [f"({_written(part)})" for part in parts]
    return f"!{texts[0]}" if kind == "!" else f" {kind} ".join(texts)


CONDITIONS = st.recursive(
    st.sampled_from(sorted(ATOMS)),
    lambda inner: st.one_of(
        st.tuples(st.just("!"), inner), st.tuples(st.sampled_from(["&&", "||"]), inner, inner, inner)
    ),
    max_leaves=8,
)


@given(CONDITIONS, st.sampled_from([1, 2]))
def test_logic_is_that_of_kleene(condition: object, ros: int) -> None:
    """The truth of a condition follows from its parts."""
    assert holds(f"#if {_written(condition)}".encode(), Macros(ros)) is _truth(condition, ros)


@given(st.binary(max_size=40))
def test_no_condition_raises_an_error(text: bytes) -> None:
    """Any text after `#if` is true, false or unknown."""
    assert holds(b"#if " + text, Macros(1)) in {True, False, None}


@pytest.mark.parametrize("condition", ["(" * 50_000, "!" * 50_000 + "1", "9" * 5_000])
def test_nothing_is_known_of_conditions_without_end(condition: str) -> None:
    """Any number of brackets, signs and digits is parsed."""
    assert holds(f"#if {condition}".encode(), Macros(2)) is None
