from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.manifests.package_xml import holds


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        (None, True),
        ("$ROS_VERSION == 2", True),
        ("$ROS_VERSION == 1", False),
        ("$ROS_VERSION != 1", True),
        ("'$ROS_VERSION' == 1", False),
        ("$ROS_DISTRO == noetic", True),
        ("$ROS_VERSION == 1 or $ROS_VERSION == 2", True),
        ("$ROS_VERSION == 2 and $ROS_VERSION == 1", False),
        ("($ROS_VERSION == 1 or $ROS_VERSION == 2) and $ROS_VERSION >= 2", True),
        ("$ROS_VERSION == 1 and ($ROS_DISTRO == noetic)", False),
        ('"a" == "a"', True),
        ("$ROS_VERSION ==", True),
        ("((((", True),
        ("$ROS_VERSION = 1", True),
    ],
)
def test_conditions(condition: str | None, expected: bool) -> None:  # noqa: FBT001  (a case)
    """A condition holds unless it is known to be false."""
    assert holds(condition, {"ROS_VERSION": "2"}) is expected


@given(st.text(alphabet="$ROS_VERSION =!<>()andor12'\"", max_size=80))
def test_any_text(condition: str) -> None:
    """Any text can be evaluated."""
    assert holds(condition, {"ROS_VERSION": "2"}) in {True, False}
