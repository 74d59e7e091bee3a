"""Results of actions whose type differs in the distribution of the robot."""

from __future__ import annotations

import asyncio

import pytest

from kg.errors import RobotError
from kg.robot.messages import Types
from kg.robot.ros2.ends import Client

HUMBLE = bytes([0, 1, 0, 0, 4, 0])
"""The status *succeeded* and the empty result of `NavigateToPose` in Humble."""


class Answering:
    """A server that returns one response."""

    def __init__(self, answer: bytes) -> None:
        self._answer = answer

    async def call(self, _: bytes) -> bytes:
        """Return the response."""
        return self._answer

    @property
    def peers(self) -> int:
        """Report an available server."""
        return 1

    async def ready(self) -> None:
        """Be ready at once."""

    def close(self) -> None:
        """Close."""


def test_a_result_of_another_version_leaves_the_status() -> None:
    """The result of Nav2 in Humble has no error codes; reaching the goal is reported in any case."""
    client = Client(Types(2), "nav2_msgs/NavigateToPose_GetResult", Answering(HUMBLE))
    assert asyncio.run(client.call({})) == {"status": 4, "result": {}}


def test_a_response_without_a_status_is_refused() -> None:
    """A response without a status is KG816."""
    client = Client(Types(2), "nav2_msgs/NavigateToPose_GetResult", Answering(HUMBLE[:4]))
    with pytest.raises(RobotError) as refused:
        asyncio.run(client.call({}))
    assert refused.value.code == "KG816"


def test_examples_of_ros_2_are_known() -> None:
    """The interfaces of the ROS 2 tutorials come with kg: a service with its numbers, an action with its list."""
    types = Types(2)
    request = types.encode("example_interfaces/AddTwoInts_Request", {"a": 2, "b": 40})
    assert types.decode("example_interfaces/AddTwoInts_Request", request) == {"a": 2, "b": 40}
    assert [one.name for one in types.fields("example_interfaces/Fibonacci_Result")] == ["sequence"]
