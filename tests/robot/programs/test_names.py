"""Names and labels of capabilities in programs."""

from __future__ import annotations

import pytest
from robot.programs.trolley import CAPABILITIES

from kg.errors import RobotError
from kg.robot.programs.names import CapabilityIndex, named
from kg.robot.programs.parse import parse
from kg.robot.programs.write import write

BY_LABEL = """\
move at a velocity  'forward speed': 0.1 m/s for 1 s
repeat 2 times
  log nearest of "scan with a laser"
  fly to the moon  x: 3
end
"""
BY_NAME = """\
drivingAtVelocity  forward: 0.1 m/s for 1 s
repeat 2 times
  log nearest of laserScanning
  fly to the moon  x: 3
end
"""


def test_labels_become_names() -> None:
    """Unknown ones remain unchanged."""
    assert write(named(parse(BY_LABEL), CAPABILITIES)) == BY_NAME


@pytest.mark.parametrize("name", ["laserScanning", "laser scanning", "LaserScanning", "Scan with a laser"])
def test_names_are_found_however_they_are_written(name: str) -> None:
    """Case and spaces are ignored, in names and in labels."""
    assert CapabilityIndex(CAPABILITIES).read(name).name == "laserScanning"


def test_the_other_way_is_told() -> None:
    """KG834 for writing a capability that can only be sensed."""
    with pytest.raises(RobotError, match="KG834"):
        CapabilityIndex(CAPABILITIES).write("laserScanning")
