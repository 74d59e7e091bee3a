"""Hints for invalid addresses of robots."""

from __future__ import annotations

import asyncio

import pytest

from kg.errors import RobotError
from kg.robot.connecting import SCHEMES, connect


@pytest.mark.parametrize(
    ("address", "hint"),
    [
        ("http://turtle:11311/", "A master of ROS 1 is written ros1://turtle:11311."),
        ("localhost:11311", "A master of ROS 1 is written ros1://localhost:11311."),
        ("drive.mcap", "A recording is written bag://drive.mcap."),
        ("turtle", "An address begins with ros1://, dds://, rclpy://, zenoh://, bag://, ws://."),
    ],
)
def test_what_to_write(address: str, hint: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A master in the form of $ROS_MASTER_URI is shown as an address of kg; any other gets the list of schemes."""
    monkeypatch.delitem(SCHEMES, "rover", raising=False)  # other tests of this process may have added it
    with pytest.raises(RobotError) as refused:
        asyncio.run(connect(address))
    assert (refused.value.code, refused.value.hint) == ("KG801", hint)
