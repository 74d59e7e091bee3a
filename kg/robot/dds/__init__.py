"""ROS 2 over DDS, without an installation of ROS 2: `dds://DOMAIN`.

    connection = await connect("dds://0", "/kg")
    connection = await connect("dds://0?clock=simulated", "/kg")     # the time is that of /clock
    connection = await connect("dds://0?distribution=humble", "/kg")     # write as Humble does, whoever is there
    connection = await connect("dds://0?types=peers", "/kg")     # request unknown types from peers

Cyclone DDS is configured by `$CYCLONEDDS_URI`, as usual.
"""

from __future__ import annotations

from kg.errors import RobotError
from kg.robot.messages import Types
from kg.robot.ros2 import Address, Ros2Connection
from kg.robot.ros2.names import absolute

__all__ = ["connect"]


async def connect(address: str, name: str, types: Types | None = None) -> Ros2Connection:
    """Join a domain as a node; the domain may be empty.

    Raises:
        RobotError: KG801 an invalid address or name, or Cyclone DDS is not installed; KG817 the domain cannot be
            joined, for example without a network.
    """
    read = Address.read(address)
    own = absolute(name)
    try:
        from cyclonedds.core import DDSException  # noqa: PLC0415 - an optional extra

        from kg.robot.dds.middleware import DdsMiddleware  # noqa: PLC0415 - it needs the extra
    except ImportError as error:
        hint = 'Install it with `pip install "kg-ros[dds]"`.'
        raise RobotError("KG801", f"Cyclone DDS is not installed: {error}", hint=hint) from None
    try:
        wire = DdsMiddleware(read.domain, own, types or Types(2), humble=read.humble, ask_types=read.ask_types)
    except DDSException as error:
        message = f"the domain {read.domain} of DDS cannot be joined: {error.msg}"
        raise RobotError("KG817", message, hint="See to the network and to $CYCLONEDDS_URI.") from None
    return await Ros2Connection.open(wire, read, own)
