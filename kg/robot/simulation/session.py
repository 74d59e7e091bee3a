"""What `kg robot simulate` does: a robot in a system of its own, or in one that runs, until it is enough."""

from __future__ import annotations

import asyncio
import os
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from kg.errors import RobotError
from kg.robot.connecting import default_address
from kg.robot.ros1 import Master
from kg.robot.ros1.xmlrpc import ask
from kg.robot.simulation.hosting import at_address
from kg.robot.tasks import ended

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from kg.robot.simulation.plan import Place
    from kg.robot.simulation.running import Simulation

__all__ = ["Choice", "opened", "simulate"]


@dataclass(frozen=True, slots=True)
class Choice:
    """What is simulated, and where.

    `address` is that of a system that runs (`ros1://HOST:PORT`, `dds://DOMAIN`); without one the robot gets a ROS
    master of its own at `port` (0: a free one), with `ros2` the domain of the environment. `speed` is None for as fast
    as can be, `seconds` how long it goes on by the time of the world. The robot begins at `start`, by default where the
    world says.
    """

    world: str
    address: str | None = None
    port: int = 0
    ros2: bool = False
    speed: float | None = 1.0
    seconds: float | None = None
    seed: int = 0
    start: Place | None = None

    @property
    def told(self) -> bool:
        """Whether the graph takes its time from the simulation, since it is not that of the wall."""
        return self.speed != 1.0


async def simulate(choice: Choice, begun: Callable[[str], None]) -> None:
    """Simulate a robot; `begun` is told the address once its nodes are there.

    Raises:
        RobotError: those of `opened`, and KG803 when the system ends before the simulation.
    """
    async with opened(choice) as (simulation, address):
        begun(address)
        await _run(simulation, choice.seconds)


@asynccontextmanager
async def opened(choice: Choice) -> AsyncIterator[tuple[Simulation, str]]:
    """Yield a simulation whose nodes are in their system, which is still to be run, and the address to connect to.

    Raises:
        RobotError: KG840 when pybullet or OpenCV is not installed, KG814 when the port is taken, KG801 and KG802 for an
            address where there is no system.
    """
    async with AsyncExitStack() as stack:
        address = await stack.enter_async_context(_system(choice))
        ros = 1 if urlsplit(address).scheme == "ros1" else 2
        if choice.told and ros == 1:
            await stack.enter_async_context(_told(address))
        if choice.told and ros > 1:
            address = f"{address}?clock=simulated"
        simulation = at_address(
            choice.world,
            address,
            ros=ros,
            speed=choice.speed,
            seed=choice.seed,
            told=choice.told,
            start=choice.start,
        )
        await stack.enter_async_context(simulation)
        yield simulation, address


async def _run(simulation: Simulation, seconds: float | None) -> None:
    running = asyncio.create_task(simulation.run(seconds))
    lost = asyncio.create_task(simulation.stage.wait_lost())
    try:
        await asyncio.wait((running, lost), return_when=asyncio.FIRST_COMPLETED)
        if not running.done():
            raise RobotError("KG803", f"the simulation has lost its system: {lost.result()}")
        running.result()
    finally:
        await ended(running, lost)


@asynccontextmanager
async def _system(choice: Choice) -> AsyncIterator[str]:
    """Yield the address of a system for the robot."""
    if choice.address:
        yield choice.address
    elif choice.ros2:
        known = default_address()
        yield known if known.startswith("dds") else f"dds://{os.environ.get('ROS_DOMAIN_ID') or 0}"
    else:
        async with Master(port=choice.port) as master:
            yield master.address


@asynccontextmanager
async def _told(address: str) -> AsyncIterator[None]:
    """Let nodes that begin at a ROS master meanwhile take their time from `/clock`."""
    master, name = f"http://{urlsplit(address).netloc}", "/use_sim_time"
    await ask(master, "setParam", "/kg", name, True)
    try:
        yield
    finally:
        with suppress(RobotError):  # a master that is gone has forgotten it
            await ask(master, "deleteParam", "/kg", name)
