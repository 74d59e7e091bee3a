"""Names of ROS 2 on the wire."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, TypeVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.ros2 import Address
from kg.robot.ros2.names import absolute, dds_topic, dds_type, is_name, ros_end, ros_type

if TYPE_CHECKING:
    from collections.abc import Callable


class RefusedError(Exception):
    """KG801 and no other code."""


def refusing(call: Callable[[], T]) -> T:
    """Return the result of a call; RefusedError for KG801."""
    try:
        return call()
    except RobotError as error:
        raise (RefusedError if error.code == "KG801" else AssertionError) from error


T = TypeVar("T")
_WORD = st.from_regex(r"[a-zA-Z][a-zA-Z0-9]{0,10}", fullmatch=True)


@pytest.mark.parametrize(
    ("kind", "service", "mangled"),
    [
        ("geometry_msgs/Twist", False, "geometry_msgs::msg::dds_::Twist_"),
        ("std_srvs/Trigger", True, "std_srvs::srv::dds_::Trigger_"),
        ("std_srvs/Trigger_Request", False, "std_srvs::srv::dds_::Trigger_Request_"),
        ("nav2_msgs/Spin_SendGoal_Response", False, "nav2_msgs::action::dds_::Spin_SendGoal_Response_"),
        ("nav2_msgs/Spin_FeedbackMessage", False, "nav2_msgs::action::dds_::Spin_FeedbackMessage_"),
        ("nav2_msgs/Spin_GetResult", True, "nav2_msgs::action::dds_::Spin_GetResult_"),
    ],
)
def test_types(kind: str, service: bool, mangled: str) -> None:  # noqa: FBT001 - a case
    """A type name on the wire includes its package and folder, and is parsed back."""
    assert dds_type(kind, service=service) == mangled
    assert ros_type(mangled) == kind


@given(st.lists(_WORD, min_size=1, max_size=4), _WORD, _WORD)
def test_ends_are_read_back(parts: list[str], package: str, kind: str) -> None:
    """The DDS topics of a topic and of a service parse to the same name and type."""
    name = "/" + "/".join(parts)
    whole = f"{package}/{kind}"
    told = ros_end(dds_topic(name, Role.PUBLISHES), dds_type(whole), writer=True)
    assert told == (Role.PUBLISHES, name, whole)
    request = dds_type(f"{whole}_Request")
    assert ros_end(dds_topic(name, Role.SERVICES), request, writer=False) == (Role.SERVICES, name, whole)
    assert ros_end(dds_topic(name, Role.CLIENTS), request, writer=True) == (Role.CLIENTS, name, whole)


@given(st.text(max_size=40), st.text(max_size=40), st.booleans())
def test_any_topic_is_read(topic: str, kind: str, writer: bool) -> None:  # noqa: FBT001 - a case
    """Any foreign topic and type is an end of ROS, or none."""
    found = ros_end(topic, kind, writer=writer)
    assert found is None or topic.startswith(("rt/", "rq/"))


@given(st.text(max_size=40))
def test_names_are_names(text: str) -> None:
    """A name is made absolute, or it is KG801."""
    with contextlib.suppress(RefusedError):
        assert is_name(refusing(lambda: absolute(text)))


@given(st.text(max_size=40))
def test_addresses_are_read(text: str) -> None:
    """Any address is parsed, or it is KG801."""
    for scheme in ("dds", "zenoh"):
        with contextlib.suppress(RefusedError):
            assert 0 <= refusing(lambda: Address.read(f"{scheme}://{text}")).domain <= 232  # noqa: B023 - called at once


def test_what_an_address_says() -> None:
    """The domain is part of the address or an option; clock and settling time are options."""
    assert Address.read("dds://7?clock=simulated").domain == 7
    assert Address.read("dds://7?clock=simulated").simulated
    assert Address.read("dds://").domain == 0
    read = Address.read("zenoh://robot:7447?domain=3&settle=0.5")
    assert (read.place, read.domain, read.settle) == ("robot:7447", 3, 0.5)
