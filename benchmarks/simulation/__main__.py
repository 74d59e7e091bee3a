"""Measures how much faster than real time the simulated robots run, and what takes the time.

    python benchmarks/simulation [--seconds 60]

Factors are seconds of the world by seconds of CPU of this process, in which everything runs: the physics, the sensors,
all nodes of the robot in memory, and the one that listens.
"""

from __future__ import annotations

import argparse
import asyncio
import time
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Final

from kg.robot.connecting import connect
from kg.robot.simulation.arm import Arm
from kg.robot.simulation.drone import Drone
from kg.robot.simulation.robots import Command
from kg.robot.simulation.running import hosted_in_memory
from kg.robot.simulation.world import World

if TYPE_CHECKING:
    from kg.robot.connection import Connection, Subscription

WORLDS: Final = ("office", "drone")


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0, help="seconds of the world that are simulated")
    seconds = parser.parse_args().seconds
    print("world   physics alone   with all nodes   with a listener to everything")
    for world in WORLDS:
        alone = physics(world, seconds)
        nodes, heard = (asyncio.run(robot(world, seconds, listen=listen)) for listen in (False, True))
        print(f"{world:6}  {alone:12.0f} x  {nodes:13.1f} x  {heard:13.1f} x")


def physics(name: str, seconds: float) -> float:
    """Return the factor of a world in which the robot moves and nobody looks."""
    with World(name) as world:
        mover = world.robot
        if isinstance(mover, Drone):
            mover.take_off()
        began = time.process_time()
        while world.time < seconds:
            if not isinstance(mover, Arm):
                mover.command(Command(forward=0.3, turn=0.5, at=world.time))
            world.advance()
        return world.time / (time.process_time() - began)


async def robot(name: str, seconds: float, *, listen: bool) -> float:
    """Return the factor of a robot with its nodes, which drives in a circle."""
    async with hosted_in_memory(name) as (simulation, address), AsyncExitStack() as stack:
        face = await connect(address, name="/benchmark")
        stack.push_async_callback(face.aclose)
        tasks = [asyncio.create_task(circle(face))]
        if listen:
            topics = {end.name for end in (await face.graph()).ends if end.role.value == "publishes"}
            tasks += [asyncio.create_task(drain(await face.subscribe(topic))) for topic in sorted(topics)]
        began, begun = time.process_time(), simulation.world.time
        await face.clock.sleep(seconds)
        taken = time.process_time() - began
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return (simulation.world.time - begun) / taken


async def circle(face: Connection) -> None:
    """Drive, or fly, in a circle."""
    velocity = await face.advertise("/cmd_vel", "geometry_msgs/Twist")
    if any(end.name == "/ardrone/takeoff" for end in (await face.graph()).ends):
        await (await face.advertise("/ardrone/takeoff", "std_msgs/Empty")).publish({})
    while True:
        await velocity.publish({"linear": {"x": 0.3}, "angular": {"z": 0.5}})
        await face.clock.sleep(0.1)


async def drain(subscription: Subscription) -> None:
    """Take all messages of a topic."""
    async for _ in subscription:
        pass


if __name__ == "__main__":
    main()
