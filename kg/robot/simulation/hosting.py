"""Simulations as robots that can be connected to: within this process, or as nodes of a system at an address."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING
from uuid import uuid4

from kg.robot.connecting import connect
from kg.robot.memory import Bus
from kg.robot.messages import Types
from kg.robot.simulation.running import Simulation

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.connection import Connection
    from kg.robot.simulation.plan import Place

__all__ = ["at_address", "hosted_in_memory", "running"]


@asynccontextmanager
async def hosted_in_memory(
    world: str, *, ros: int = 1, seed: int = 0, start: Place | None = None
) -> AsyncIterator[tuple[Simulation, str]]:
    """Run a world in this process as fast as can be; yield it with its address. `start` is as for `Simulation`.

    Raises:
        RobotError: KG840 when pybullet or OpenCV is not installed.
    """
    with Bus(f"{world}-{uuid4().hex[:8]}", ros=ros) as bus:

        async def join(name: str) -> Connection:
            return bus.join(name)

        simulation = Simulation(world, join, ros=ros, speed=None, seed=seed, start=start)
        bus.clock = simulation.world.clock
        async with simulation, running(simulation):
            yield simulation, bus.address


def at_address(  # noqa: PLR0913 - what can be chosen of a simulation
    world: str,
    address: str,
    *,
    ros: int = 1,
    speed: float | None = 1.0,
    seed: int = 0,
    told: bool = False,
    start: Place | None = None,
) -> Simulation:
    """Return a world as nodes of the system at an address; it is to be opened, and to be run.

    `told` makes messages have the time of the world instead of the wall's, which is published on `/clock`.

    Raises:
        RobotError: KG840 when pybullet or OpenCV is not installed; opening it raises those of `connect`.
    """
    types = Types(ros)

    async def join(name: str) -> Connection:
        return await connect(address, name=name, types=types)

    return Simulation(world, join, ros=ros, speed=speed, seed=seed, told=told, start=start)


@asynccontextmanager
async def running(simulation: Simulation) -> AsyncIterator[None]:
    """Let time pass in a simulation that is open; when it fails, the body is ended, and that is raised in its place."""
    body = asyncio.current_task()
    task = asyncio.create_task(simulation.run())

    def ended(_: asyncio.Task[None]) -> None:
        if body is not None and _failure(task) is not None:
            body.cancel()

    task.add_done_callback(ended)
    try:
        try:
            yield
        finally:
            task.remove_done_callback(ended)
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
    except asyncio.CancelledError:  # of the body, or, where it was just at its end, of the waiting behind it
        failure = _failure(task)
        if failure is None or body is None:
            raise
        body.uncancel()
        raise failure from None


def _failure(task: asyncio.Task[None]) -> BaseException | None:
    return task.exception() if task.done() and not task.cancelled() else None
