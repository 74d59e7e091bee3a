"""A look at a running system: connect, take its graph, leave."""

from __future__ import annotations

import asyncio
import os
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.robot.connecting import connect, default_address
from kg.robot.infrastructure import of_robot

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.connection import ComputationGraph, Connection
    from kg.settings import Settings

__all__ = ["address_of", "connected", "inhabited", "look"]

_DISCOVERED: Final = 2
"""The version of ROS whose nodes are found by waiting, since no master lists them."""


def address_of(settings: Settings) -> str:
    """Return the address of the robot in force: that of the settings, else that of the environment."""
    return settings.robot or default_address()


@asynccontextmanager
async def connected(address: str) -> AsyncIterator[Connection]:
    """Be a node of the system at an address for a while, of a name that no other process has.

    Raises:
        RobotError: KG801 for an address of another form, KG802 when nothing answers there.
    """
    connection = await connect(address, name=f"/kg_{os.getpid()}")
    try:
        yield connection
    finally:
        await connection.aclose()


async def inhabited(connection: Connection) -> ComputationGraph:
    """Return the computation graph of a robot; RobotError KG802 when there is no node but ours and those of ROS itself.

    A master whose robot does not run answers to everybody, and lists `/rosout`. A domain of
    DDS answers to everybody, too: one without nodes is a wrong number, or a robot that does not run.
    """
    loop = asyncio.get_running_loop()
    begun = loop.time()
    graph = of_robot(await connection.graph())
    if not graph.nodes:
        waited = f" within {max(1, round(loop.time() - begun))} s" if graph.ros == _DISCOVERED else ""
        raise RobotError("KG802", f"no node was found at {connection.address}{waited}")
    return graph


async def look(address: str) -> ComputationGraph:
    """Return the computation graph of the system at an address; raises as `connected` and `inhabited`."""
    async with connected(address) as connection:
        return await inhabited(connection)
