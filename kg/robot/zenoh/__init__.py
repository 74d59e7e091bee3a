"""ROS 2 over Zenoh, without an installation of ROS 2: `zenoh://HOST:PORT`, compatible with rmw_zenoh_cpp.

    connection = await connect("zenoh://localhost:7447", "/kg")
    connection = await connect("zenoh://robot.local?domain=5", "/kg")     # port 7447, ROS domain 5

The address is that of a router (`rmw_zenohd`), or of any peer.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from kg.errors import RobotError
from kg.robot.messages import Types
from kg.robot.ros2 import Address, Ros2Connection
from kg.robot.ros2.names import absolute

if TYPE_CHECKING:
    from kg.robot.zenoh.middleware import ZenohMiddleware

__all__ = ["connect"]


async def connect(address: str, name: str, types: Types | None = None) -> Ros2Connection:
    """Join the system of a Zenoh router or peer as a node.

    Raises:
        RobotError: KG801 an invalid address or name, or Zenoh is not installed; KG802 nothing listens there; KG817 no
            session can be opened.
    """
    read = Address.read(address)
    own = absolute(name)
    return await Ros2Connection.open(await asyncio.to_thread(_joined, read, own, types or Types(2)), read, own)


def _joined(address: Address, name: str, types: Types) -> ZenohMiddleware:
    try:
        import zenoh  # noqa: PLC0415 - an optional extra

        from kg.robot.zenoh.middleware import ZenohMiddleware, configuration  # noqa: PLC0415 - need the extra
    except ImportError as error:
        hint = 'Install it with `pip install "kg-ros[zenoh]"`.'
        raise RobotError("KG801", f"Zenoh is not installed: {error}", hint=hint) from None
    try:
        settings = configuration(address.place)
    except zenoh.ZError as error:
        raise RobotError("KG817", f"`{address.text}` cannot be a place to connect to: {error}") from None
    try:
        session = zenoh.open(settings)
    except zenoh.ZError:
        hint = "A router is started by `ros2 run rmw_zenoh_cpp rmw_zenohd`."
        raise RobotError("KG802", f"no router or peer of Zenoh answers at {address.place}", hint=hint) from None
    return ZenohMiddleware(session, address.domain, name, types)
