"""Type hashes equal those computed by ROS 2."""

from __future__ import annotations

import pytest

from kg.errors import RobotError
from kg.robot.messages import Types
from kg.robot.ros2.types import type_hash

# as printed by distributions of ROS 2: `ros2 topic info -v`, docs/design.md of rmw_zenoh
_MESSAGES = {
    "std_msgs/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "std_msgs/Header": "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
    "geometry_msgs/TwistStamped": "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
    "sensor_msgs/Imu": "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
    "nav_msgs/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "action_msgs/GoalStatusArray": "6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e",
}
_SERVICES = {
    "example_interfaces/AddTwoInts": "e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a",
    "rcl_interfaces/GetParameters": "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc",
    "rcl_interfaces/DescribeParameters": "845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff",
    "action_tutorials_interfaces/Fibonacci_GetResult": (
        "8b47e383f1e31f6d8df6417ab54957e7d5ea24dad315646ad711ac3fdea81d58"
    ),
}


@pytest.fixture(scope="module")
def types() -> Types:
    """Return the types of ROS 2 with a service and an action of its tutorials."""
    made = Types(2)
    made.define("example_interfaces/AddTwoInts", "int64 a\nint64 b\n---\nint64 sum\n", "srv")
    fibonacci = "int32 order\n---\nint32[] sequence\n---\nint32[] partial_sequence\n"
    made.define("action_tutorials_interfaces/Fibonacci", fibonacci, "action")
    return made


@pytest.mark.parametrize(("kind", "digest"), _MESSAGES.items())
def test_messages(types: Types, kind: str, digest: str) -> None:
    """A message has the hash printed by ROS 2."""
    assert type_hash(types, kind) == f"RIHS01_{digest}"


@pytest.mark.parametrize(("kind", "digest"), _SERVICES.items())
def test_services(types: Types, kind: str, digest: str) -> None:
    """A service, also one of an action, has the hash printed by ROS 2."""
    assert type_hash(types, kind, service=True) == f"RIHS01_{digest}"


def test_a_type_that_is_not_known(types: Types) -> None:
    """An unknown type has no hash: KG804."""
    with pytest.raises(RobotError) as unknown:
        type_hash(types, "nowhere_msgs/Thing")
    assert unknown.value.code == "KG804"
