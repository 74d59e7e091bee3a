"""Running simulations: the world, the nodes and the pace of time, in this process or in a system at an address."""

from __future__ import annotations

import asyncio
import os
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Self
from urllib.parse import urlsplit
from uuid import uuid4

from kg.errors import RobotError
from kg.robot.clock import stamp
from kg.robot.connecting import connect, default_address
from kg.robot.memory import Bus
from kg.robot.messages import Types
from kg.robot.programs.places import TOPIC as PLACES
from kg.robot.ros1 import Master
from kg.robot.ros1.xmlrpc import ask
from kg.robot.simulation.arm import Arm
from kg.robot.simulation.arm_nodes import arm_nodes
from kg.robot.simulation.drone import Drone
from kg.robot.simulation.nodes import drone_nodes, office_nodes
from kg.robot.simulation.stage import Join, Stage
from kg.robot.simulation.view import TopView
from kg.robot.simulation.world import World
from kg.robot.tasks import first

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from kg.robot.connection import Connection
    from kg.robot.simulation.plan import Place

VIEW: Final = "/simulator/view"
"""The topic (`std_msgs/String`) of the view from above, as SVG, which pages show."""

_TURNS: Final = 8
"""Turns of the event loop between two steps of an unpaced simulation, for nodes to receive, decide and respond."""

_LATE: Final = 0.2  # maximum delay in seconds that the simulation makes up for; beyond, it is slower than requested


class Simulation:
    """A world with the nodes of its robot, which join inside `async with`.

    Args:
        name: of the world.
        join: adds a node to the graph, by name.
        ros: the version of ROS.
        speed: seconds of the world per wall-clock second; None for as fast as possible.
        seed: of the noise.
        simulated_time: whether the graph uses the simulation's time: `/clock` is published, and stamps messages.
        start: initial pose of the robot, by default that of the plan.
    """

    def __init__(  # noqa: PLR0913 - what a simulation is made of
        self,
        name: str,
        join: Join,
        *,
        ros: int = 1,
        speed: float | None = 1.0,
        seed: int = 0,
        simulated_time: bool = True,
        start: Place | None = None,
    ) -> None:
        """Raise RobotError KG840 if pybullet or OpenCV is not installed."""
        self.world = World(name, seed=seed, start=start)
        self.stage = Stage(self.world, join, ros=ros, simulated=simulated_time)
        self.view = TopView(self.world)
        self._speed = speed

    async def __aenter__(self) -> Self:
        try:
            await self._robot()
            await self._simulator()  # last: nodes that join a system with simulated time wait for it
        except BaseException:
            await self.aclose()
            raise
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.aclose()

    async def aclose(self) -> None:
        """Let the nodes leave, and end the physics."""
        await self.stage.aclose()
        self.world.close()

    async def _robot(self) -> None:
        match self.world.robot:
            case Drone() as drone:
                await drone_nodes(self.stage, drone)
            case Arm() as arm:
                await arm_nodes(self.stage, arm)
            case wheeled:
                await office_nodes(self.stage, wheeled)

    async def _simulator(self) -> None:
        """Let the simulator's own node join, which publishes the time, the places, and the view of the world."""
        node = await self.stage.node("/simulator")
        if self.stage.simulated:
            kind = "rosgraph_msgs/Clock"
            await node.publish_every("/clock", kind, self.world.step, lambda: {"clock": stamp(self.world.time)})
        places = await node.advertise(PLACES, "std_msgs/String", latch=True)
        await places.publish({"data": self.world.plan.places()})
        await node.publish_every(VIEW, "std_msgs/String", 0.25 * (self._speed or 1), lambda: {"data": self.view.svg()})

    async def run(self, seconds: float | None = None) -> None:
        """Advance the world by some seconds, or until cancelled."""
        loop = asyncio.get_running_loop()
        end = None if seconds is None else self.world.time + seconds
        begun, at = loop.time(), self.world.time
        while end is None or self.world.time < end:
            self.world.advance()
            await self.stage.work()
            if self._speed is None:
                for _ in range(_TURNS):
                    await asyncio.sleep(0)
                continue
            wait = begun + (self.world.time - at) / self._speed - loop.time()
            if wait < -_LATE:
                begun, at = loop.time(), self.world.time
            await asyncio.sleep(max(0.0, wait))


@asynccontextmanager
async def hosted_in_memory(
    world: str, *, ros: int = 1, start: Place | None = None
) -> AsyncIterator[tuple[Simulation, str]]:
    """Run a world in this process as fast as possible; yield it with its address. `start` is as for `Simulation`.

    Raises:
        RobotError: KG840 pybullet or OpenCV is not installed.
    """
    with Bus(f"{world}-{uuid4().hex[:8]}", ros=ros) as bus:

        async def join(name: str) -> Connection:
            return bus.join(name)

        simulation = Simulation(world, join, ros=ros, speed=None, start=start)
        bus.clock = simulation.world.clock
        async with simulation, running(simulation):
            yield simulation, bus.address


@asynccontextmanager
async def running(simulation: Simulation) -> AsyncIterator[None]:
    """Advance an open simulation during the body; its failure ends the body and is raised instead."""
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
    except asyncio.CancelledError:  # of the body, or, if it was just ending, of the wait after it
        failure = _failure(task)
        if failure is None or body is None:
            raise
        body.uncancel()
        raise failure from None


def _failure(task: asyncio.Task[None]) -> BaseException | None:
    return task.exception() if task.done() and not task.cancelled() else None


@dataclass(frozen=True, slots=True)
class Choice:
    """The simulation to run, and its system.

    `address` is that of a running system (`ros1://HOST:PORT`, `dds://DOMAIN`). Without one, the robot gets a ROS master
    of its own at `port` (0: any free one), or with `ros2` the domain of the environment. `speed` is None for as fast as
    possible, `seconds` the duration in the time of the world. The robot starts at `start`, by default the world's.
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
    def simulated_time(self) -> bool:
        """Whether the graph uses the simulation's time, since it differs from the wall clock."""
        return self.speed != 1.0


async def simulate(choice: Choice, begun: Callable[[str], None]) -> None:
    """Run a simulation; `begun` is called with the address once its nodes have joined.

    Raises:
        RobotError: those of `opened`, and KG803 when the system ends before the simulation.
    """
    async with opened(choice) as (simulation, address):

        async def lost() -> None:
            raise RobotError("KG803", f"the simulation has lost its system: {await simulation.stage.wait_lost()}")

        begun(address)
        await first(simulation.run(choice.seconds), lost())


@asynccontextmanager
async def opened(choice: Choice) -> AsyncIterator[tuple[Simulation, str]]:
    """Yield a simulation whose nodes have joined, still to be run, and the address to connect to.

    Raises:
        RobotError: KG840 pybullet or OpenCV is not installed, KG814 the port is in use, KG801 and KG802 no system at
            the address.
    """
    async with AsyncExitStack() as stack:
        address = await stack.enter_async_context(_system(choice))
        ros = 1 if urlsplit(address).scheme == "ros1" else 2
        if choice.simulated_time and ros == 1:
            await stack.enter_async_context(_using_simulated_time(address))
        if choice.simulated_time and ros > 1:
            address = f"{address}?clock=simulated"
        types = Types(ros)

        async def join(name: str) -> Connection:
            return await connect(address, name=name, types=types)

        simulation = Simulation(
            choice.world,
            join,
            ros=ros,
            speed=choice.speed,
            seed=choice.seed,
            simulated_time=choice.simulated_time,
            start=choice.start,
        )
        await stack.enter_async_context(simulation)
        yield simulation, address


@asynccontextmanager
async def _system(choice: Choice) -> AsyncIterator[str]:
    if choice.address:
        yield choice.address
    elif choice.ros2:
        address = default_address()
        yield address if address.startswith("dds") else f"dds://{os.environ.get('ROS_DOMAIN_ID') or 0}"
    else:
        async with Master(port=choice.port) as master:
            yield master.address


@asynccontextmanager
async def _using_simulated_time(address: str) -> AsyncIterator[None]:
    """Let nodes that join a ROS master inside the context use the time of `/clock`."""
    master, name = f"http://{urlsplit(address).netloc}", "/use_sim_time"
    await ask(master, "setParam", "/kg", name, True)
    try:
        yield
    finally:
        with suppress(RobotError):  # a master that is gone has lost it
            await ask(master, "deleteParam", "/kg", name)
