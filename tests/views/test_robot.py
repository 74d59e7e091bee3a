from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UnknownNameError, UsageError
from kg.views.robot import capabilities

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def test_a_system_tells_what_it_can_do(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Capabilities have their ways; general ones are counted, and listed on request."""
    found = capabilities(snapshot, settings, system="rover.launch")
    names = {one["name"] for one in found["capabilities"]}
    assert found["of"] == "rover_robot/launch/rover.launch"
    assert {"drivingAtVelocity", "sensingPose"} <= names
    assert found["general"] > 0
    every = capabilities(snapshot, settings, system="rover.launch", every="yes")
    assert len(every["capabilities"]) == len(names) + found["general"]


def test_a_package_tells_what_it_would_add(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Relative to a system, only capabilities missing there are listed."""
    alone = {one["name"] for one in capabilities(snapshot, settings, package="drone_control")["capabilities"]}
    beside = capabilities(snapshot, settings, package="drone_control", system="rover.launch")["capabilities"]
    rover = {
        one["name"] for one in capabilities(snapshot, settings, system="rover.launch", every="yes")["capabilities"]
    }
    assert {one["name"] for one in beside} == alone - rover


def test_what_is_not_there_is_said(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An unknown or missing name is the caller's error."""
    with pytest.raises(UnknownNameError) as unknown:
        capabilities(snapshot, settings, package="rover_robt")
    assert unknown.value.code == "KG001"
    with pytest.raises(UsageError):
        capabilities(snapshot, settings)
