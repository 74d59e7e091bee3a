"""The connection of a server to its robot: made, followed, and made again when it is lost."""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.robot.capability import Capabilities
from kg.robot.connecting import connect, of_robot
from kg.robot.driving import Driver, Watchdog
from kg.robot.live import infer
from kg.robot.programs.places import offered, offers, read_places
from kg.robot.tasks import ended
from kg.server.robot.ends import failure
from kg.server.robot.pictures import Picture, has_picture
from kg.server.robot.proving import Proofs

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.errors import KgError
    from kg.robot.connection import ComputationGraph, Connection, GraphProblem
    from kg.robot.programs.places import Places
    from kg.settings import Settings

__all__ = ["Link"]

_PAUSE: Final = 2.0
"""Seconds until a robot that does not answer is asked again."""


class Link:
    """What is known of the robot.

    `changed` is called when that changes, `warn` when another node drives the robot, too, `leave` before a driver is
    given up. `state` is `connecting`, `connected` or
    `lost`; `problem` says why it is not connected. `places` are those of the settings and those that the robot tells,
    by name, `graph` who is there. `driver` is there while the robot can be driven, `picture` when a
    simulation shows itself.
    """

    def __init__(
        self,
        address: str,
        settings: Settings,
        changed: Callable[[], None],
        warn: Callable[[GraphProblem], None],
        leave: Callable[[], Awaitable[None]],
    ) -> None:
        self.address = address
        self.state = "connecting"
        self.problem: KgError | None = None
        self.capabilities = Capabilities(of=address)
        self.graph: ComputationGraph | None = None
        self.picture: Picture | None = None
        self.proofs = Proofs(address, settings)
        self.driver: Driver | None = None
        self._settings = settings
        self._own: Places = read_places(settings.places)
        self.places = self._own
        self._offers: bool | None = None
        self._changed = changed
        self._warn = warn
        self._leave = leave

    def needed(self) -> Driver:
        """Return what drives the robot; RobotError KG846 while it is not connected."""
        if self.driver is None:
            why = f": {self.problem.message}" if self.problem else ""
            raise RobotError("KG846", f"the robot at {self.address} is not connected{why}")
        return self.driver

    async def keep(self) -> None:
        """Stay connected until cancelled, whatever goes wrong."""
        while True:
            trying = asyncio.create_task(self._connected())
            try:
                await asyncio.wait((trying,))
            finally:
                await ended(trying)
            self._be("lost" if self.state == "connected" else self.state, failure(trying, "following the robot"))
            await asyncio.sleep(_PAUSE)

    async def _connected(self) -> None:
        """Be connected until the robot is lost: raises why."""
        async with AsyncExitStack() as stack:
            connection = await connect(self.address, name="/kg_page")
            stack.push_async_callback(connection.aclose)
            stack.push_async_callback(self._unseen)
            following = asyncio.ensure_future(self._follow(connection))
            stack.push_async_callback(ended, following)
            lost = asyncio.ensure_future(connection.wait_lost())
            stack.push_async_callback(ended, lost)
            await asyncio.wait((following, lost), return_when=asyncio.FIRST_COMPLETED)
            if following.done():
                following.result()
            raise RobotError("KG803", lost.result() if lost.done() else "the connection to the robot was lost")

    async def _follow(self, connection: Connection) -> None:
        """Keep capabilities and driver in step with the computation graph."""
        try:
            async for graph in connection.changes():
                if self.driver is not None:
                    self.driver.saw(graph)
                await self._take(connection, of_robot(graph))
        finally:
            self.proofs.take(None)
            self._offers = None
            await self._give_up()

    async def _take(self, connection: Connection, graph: ComputationGraph) -> None:
        self.proofs.take(graph)
        if has_picture(graph) != (self.picture is not None):
            await self._unseen()
            self.picture = Picture(connection) if has_picture(graph) else None
            self._changed()
        if offers(graph) != self._offers:
            self._offers = offers(graph)
            self.places = {**await offered(connection, graph), **self._own}
            self._changed()
        found = await asyncio.to_thread(infer, graph, self._settings, address=self.address)
        doubted = graph.problems != (self.graph.problems if self.graph else ())
        self.graph = graph
        if self.driver is None:
            watchdog = Watchdog(self.address, self._settings.watchdog)
            driver = Driver(connection, found, on_problem=self._warn, watchdog=watchdog, graph=graph)
            await driver.__aenter__()
            self.driver = driver
        elif found != self.capabilities:
            await self.driver.take(found)
        elif not doubted:
            return
        self.capabilities = found
        self._be("connected")

    async def _unseen(self) -> None:
        if (picture := self.picture) is not None:
            self.picture = None
            await picture.aclose()

    async def _give_up(self) -> None:
        if (driver := self.driver) is not None:
            try:
                await self._leave()
            finally:  # it stops the robot also when what leads up to that fails, or is cancelled once more
                self.driver = None
                await driver.__aexit__(None, None, None)

    def _be(self, state: str, problem: KgError | None = None) -> None:
        self.state, self.problem = state, problem
        self._changed()
