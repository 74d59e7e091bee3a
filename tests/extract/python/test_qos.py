from __future__ import annotations

import pytest
from extract.python.programs import values_of

from kg.extract.python.qos import quality
from kg.facts import Qos

HEAD = "import rclpy.qos\nfrom rclpy.qos import *\nfrom rclpy.qos import QoSProfile, DurabilityPolicy\n"


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
        ("unknown()", None),
    ],
)  # fmt: skip
def test_profiles(expression: str, qos: Qos | None) -> None:
    """Depths, presets and profiles give the quality of service that rclpy gives them."""
    assert [quality(value) for value in values_of(f"{HEAD}x = {expression}\n")] == [qos]


def test_a_profile_can_be_refined() -> None:
    """Policies that are assigned to a profile later belong to it."""
    text = "p = QoSProfile(depth=1)\np.durability = DurabilityPolicy.TRANSIENT_LOCAL\np.depth = 4\nx = p\n"
    assert [quality(value) for value in values_of(HEAD + text)] == [Qos("reliable", "transient_local", "keep_last", 4)]
