"""Exchange of ROS 1 bags between kg and Debian's `rosbag`, an independent implementation."""

from __future__ import annotations

import asyncio
import json
import subprocess
from typing import TYPE_CHECKING
from uuid import uuid4

import pytest
from robot.ros1.debian import needs

from kg.robot.bag.recording import Recorder
from kg.robot.clock import WallClock
from kg.robot.connecting import connect
from kg.robot.memory import Bus

if TYPE_CHECKING:
    from pathlib import Path

PYTHON = "/usr/bin/python3"
pytestmark = [
    pytest.mark.ros,
    needs(PYTHON, *(f"/usr/lib/python3/dist-packages/{one}" for one in ("rosbag", "roslz4", "rospy", "std_msgs"))),
]

READ = """
import json, sys, rosbag
bag = rosbag.Bag(sys.argv[1])
read = bag.read_messages(return_connection_header=True)
print(json.dumps([(topic, one.data, at.to_sec(), header["latching"].decode()) for topic, one, at, header in read]))
"""
WRITE = """
import sys, rosbag, rospy
from std_msgs.msg import String
with rosbag.Bag(sys.argv[1], "w", compression=sys.argv[2]) as bag:
    for one in range(5):
        bag.write("/text", String(data=str(one)), rospy.Time(1700000000, one * 10000000))
"""


def test_debian_reads_what_is_recorded(tmp_path: Path) -> None:
    """Debian reads the topics, types, values and times recorded by kg, and which publishers are latched."""
    path = tmp_path / "drive.bag"

    async def scene() -> float:
        with Bus(uuid4().hex, ros=1, clock=WallClock()) as bus:
            text = await bus.join("/robot").advertise("/text", "std_msgs/String", latch=True)
            await text.publish({"data": "höher"})
            recorder = Recorder(bus.join("/kg"), path)
            running = asyncio.ensure_future(recorder.run())
            while not recorder.written:  # noqa: ASYNC110 - the recorder tells nobody
                await asyncio.sleep(0.005)
            running.cancel()
            await asyncio.wait({running})
            recorder.close()
            return recorder.first

    at = asyncio.run(scene())
    read = subprocess.run([PYTHON, "-c", READ, path], capture_output=True, text=True, check=True)
    assert json.loads(read.stdout) == [["/text", "höher", pytest.approx(at, abs=1e-5), "1"]]


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_a_bag_of_debian_is_played(tmp_path: Path, compression: str) -> None:
    """A bag of Debian's rosbag, compressed or not, is read completely."""
    path = tmp_path / "drive.bag"
    subprocess.run([PYTHON, "-c", WRITE, path, compression], check=True)

    async def scene() -> list[str]:
        connection = await connect(f"bag://{path}", name="/kg")
        try:
            return [one.value["data"] async for one in await connection.subscribe("/text")]
        finally:
            await connection.aclose()

    assert asyncio.run(scene()) == ["0", "1", "2", "3", "4"]
