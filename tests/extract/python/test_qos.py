from __future__ import annotations

import pytest
from extract.python.programs import values_of

from kg.facts import Qos
from kg.symbolic.qos import profile_of as quality

HEAD = (
    "import rclpy.qos\nfrom rclpy.qos import *\nfrom rclpy.qos import QoSProfile, DurabilityPolicy\n"
    "from rclpy.qos import LivelinessPolicy\nfrom rclpy.duration import Duration, Infinite\n"
    "MANUAL = LivelinessPolicy.MANUAL_BY_TOPIC\n"
)


@pytest.mark.parametrize(
    ("expression", "qos"),
    [
        ("7", Qos("reliable", "volatile", "keep_last", 7)),
        ("rclpy.qos.qos_profile_sensor_data", Qos("best_effort", "volatile", "keep_last", 5)),
        ("rclpy.qos.QoSPresetProfiles.SENSOR_DATA.value", Qos("best_effort", "volatile", "keep_last", 5)),
        ("QoSProfile(depth=3)", Qos("reliable", "volatile", "keep_last", 3)),
        ("QoSProfile(history=rclpy.qos.HistoryPolicy.KEEP_ALL)", Qos("reliable", "volatile", "keep_all", None)),
        ("QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)",
         Qos("reliable", "transient_local", "keep_last", 1)),
        ("QoSProfile(depth=1, reliability=rclpy.qos.QoSReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT)",
         Qos("best_effort", "volatile", "keep_last", 1)),
        ("rclpy.qos.QoSPresetProfiles.get_from_short_key('sensor_data')",
         Qos("best_effort", "volatile", "keep_last", 5)),
        ("QoSProfile(depth=1, deadline=Duration(seconds=1, nanoseconds=500000000), lifespan=Duration(seconds=2))",
         Qos("reliable", "volatile", "keep_last", 1, deadline=1.5, lifespan=2.0)),
        ("QoSProfile(depth=1, liveliness=MANUAL, liveliness_lease_duration=Duration(nanoseconds=250_000_000))",
         Qos("reliable", "volatile", "keep_last", 1, liveliness="manual_by_topic", lease_duration=0.25)),
        ("QoSProfile(depth=1, deadline=Duration(), lifespan=Infinite, liveliness=LivelinessPolicy.SYSTEM_DEFAULT)",
         Qos("reliable", "volatile", "keep_last", 1)),
        ("QoSProfile(depth=1, deadline=Duration(seconds=PERIOD))", None),
        ("unknown()", None),
    ],
)  # fmt: skip
def test_profiles(expression: str, qos: Qos | None) -> None:
    """Depths, presets and profiles give the same quality of service as in rclpy."""
    assert [quality(value) for value in values_of(f"{HEAD}x = {expression}\n")] == [qos]


def test_a_profile_can_be_refined() -> None:
    """Policies assigned to a profile later belong to it."""
    text = "p = QoSProfile(depth=1)\np.durability = DurabilityPolicy.TRANSIENT_LOCAL\np.depth = 4\nx = p\n"
    assert [quality(value) for value in values_of(HEAD + text)] == [Qos("reliable", "transient_local", "keep_last", 4)]


def test_a_preset_can_be_refined() -> None:
    """Policies assigned to a preset of rclpy belong to it, including durations."""
    text = "p = rclpy.qos.qos_profile_sensor_data\np.deadline = Duration(seconds=3)\nx = p\n"
    wanted = Qos("best_effort", "volatile", "keep_last", 5, deadline=3.0)
    assert [quality(value) for value in values_of(HEAD + text)] == [wanted]


def test_a_profile_refined_by_what_is_not_known() -> None:
    """An unknown deadline makes the whole profile unknown, because no deadline would have another meaning."""
    text = "p = QoSProfile(depth=1)\np.deadline = period()\nx = p\n"
    assert [quality(value) for value in values_of(HEAD + text)] == [None]
