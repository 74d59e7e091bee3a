"""A robot within this process: what tests and the simulation talk to; `memory://NAME` names one.

    with Bus("office", ros=1, clock=SimulatedClock()) as bus:
        robot = bus.join("/robot")                  # a node; as many as are wanted
        face = await connect("memory://office")     # another one, as anybody connects to any robot

What is sent is checked and completed by the types of messages, so that what does not fit is found as on a real wire.
"""

from __future__ import annotations

from urllib.parse import urlsplit

from kg.errors import RobotError
from kg.robot.memory.bus import Bus
from kg.robot.memory.node import MemoryConnection
from kg.robot.messages import Types  # noqa: TC001 - `connect` is looked up by its name

__all__ = ["Bus", "MemoryConnection", "connect"]


async def connect(address: str, name: str, types: Types | None = None) -> MemoryConnection:
    """Become a node of the bus that `memory://NAME` names; RobotError KG802 when this process has none of that name."""
    bus = Bus.named(urlsplit(address).netloc)
    if bus is None:
        raise RobotError("KG802", f"no robot `{address}` in this process")
    return bus.join(name, types)
