"""Recordings as robots: `bag://FILE`, a bag of ROS 1 (`.bag`) or ROS 2 (`.mcap`, `.db3`, the folder of both).

    connection = await connect("bag://drive.mcap", "/kg")
    connection = await connect("bag://drive.mcap?start=30&speed=2", "/kg")    # from second 30 on, twice as fast

It is played from the moment that the first topic is subscribed: values come in the time that they were recorded at.
Nothing can be commanded. `kg.robot.bag.recording` writes such files from running robots.
"""

from __future__ import annotations

import asyncio

from kg.robot.bag.connection import BagAddress, BagConnection
from kg.robot.bag.files import Bag
from kg.robot.messages import Types  # noqa: TC001 - `connect` is looked up by its name

__all__ = ["Bag", "BagAddress", "BagConnection", "connect"]


async def connect(address: str, name: str, types: Types | None = None) -> BagConnection:
    """Open a recording.

    Raises:
        RobotError: KG801 for an address of another form, KG850 for a file that cannot be read.
    """
    read = BagAddress.read(address)
    return BagConnection(await asyncio.to_thread(Bag, read.path, types), read, name)
