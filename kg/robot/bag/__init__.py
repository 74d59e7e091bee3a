"""Recordings as robots: `bag://FILE`, a bag of ROS 1 (`.bag`) or ROS 2 (`.mcap`, `.db3`, or the folder of either).

    connection = await connect("bag://drive.mcap", "/kg")
    connection = await connect("bag://drive.mcap?start=30&speed=2", "/kg")    # from second 30 on, twice as fast

Playback starts with the first subscription, and messages arrive at their recorded times. Recordings cannot be
commanded. `kg.robot.bag.recording` writes such files from running robots.
"""

from __future__ import annotations

import asyncio

from kg.robot.bag.connection import BagAddress, BagConnection
from kg.robot.bag.files import Bag
from kg.robot.messages import Types  # noqa: TC001 - `connect` is looked up by its name

__all__ = ["Bag", "BagAddress", "BagConnection", "connect"]


async def connect(address: str, name: str, types: Types | None = None) -> BagConnection:
    """Open a recording; RobotError KG801 an invalid address, KG850 an unreadable file."""
    read = BagAddress.read(address)
    return BagConnection(await asyncio.to_thread(Bag, read.path, types), read, name)
