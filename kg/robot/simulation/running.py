"""A simulation that runs: the world, the nodes, and the pace of time."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from kg.robot.programs.places import TOPIC as PLACES
from kg.robot.simulation.drone import Drone
from kg.robot.simulation.drone_nodes import drone_nodes
from kg.robot.simulation.office_nodes import office_nodes
from kg.robot.simulation.stage import Stage, stamped
from kg.robot.simulation.view import TopView
from kg.robot.simulation.world import World

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from kg.robot.simulation.plan import Place
    from kg.robot.simulation.stage import Join

__all__ = ["VIEW", "Simulation"]

VIEW: Final = "/simulator/view"
"""The topic (`std_msgs/String`) of the world from above, as SVG: a page shows it, wherever the simulation runs."""

_TURNS: Final = 8
"""How often others may go on between two steps when time does not wait for them: to hear, to decide, to answer."""

_LATE: Final = 0.2
"""Seconds that the simulation catches up at most; beyond, it is slower than it should be."""


class Simulation:
    """A world with the nodes of its robot; `async with` lets them join and leave.

    Args:
        name: of the world.
        join: how a node of a name becomes part of the graph.
        ros: the version of ROS that is spoken.
        speed: how many seconds of the world pass in one of the wall; None for as fast as can be.
        seed: of the noise.
        told: whether the graph takes its time from the simulation: `/clock` is published, and messages have the time
            of the world.
        start: where the robot begins, by default where the plan says.
    """

    def __init__(  # noqa: PLR0913 - what a simulation is made of
        self,
        name: str,
        join: Join,
        *,
        ros: int = 1,
        speed: float | None = 1.0,
        seed: int = 0,
        told: bool = True,
        start: Place | None = None,
    ) -> None:
        """Raise RobotError KG840 when pybullet or OpenCV is not installed."""
        self.world = World(name, seed=seed, start=start)
        self.stage = Stage(self.world, join, ros=ros, simulated=told)
        self.view = TopView(self.world)
        self._speed = speed

    async def __aenter__(self) -> Self:
        try:
            robot = self.world.robot
            await (drone_nodes(self.stage, robot) if isinstance(robot, Drone) else office_nodes(self.stage, robot))
            await self._simulator()  # last: who joins where the time is told waits for it
        except BaseException:
            await self.aclose()
            raise
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.aclose()

    async def aclose(self) -> None:
        """Let the nodes leave, and end the physics."""
        await self.stage.aclose()
        self.world.close()

    async def _simulator(self) -> None:
        """Let the simulation be a node of its own, which tells the time and the places, and shows the world."""
        node = await self.stage.node("/simulator")
        if self.stage.simulated:
            kind = "rosgraph_msgs/Clock"
            await node.tells("/clock", kind, self.world.step, lambda: {"clock": stamped(self.world.time)})
        places = await node.tell(PLACES, "std_msgs/String", latch=True)
        await places.publish({"data": self.world.plan.places()})
        await node.tells(VIEW, "std_msgs/String", 0.25 * (self._speed or 1), lambda: {"data": self.view.svg()})

    async def run(self, seconds: float | None = None) -> None:
        """Let so many seconds of the world pass, or go on until it is cancelled."""
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
