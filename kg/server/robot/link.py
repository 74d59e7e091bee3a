"""The connection of a server to its robot: opened, watched, and reopened when it is lost.

It provides the picture that a simulation publishes of itself, while somebody watches, and proofs of the robot's
capabilities, down to the running node or the line of code.
"""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Any, Final

from kg.errors import KgError, RobotError
from kg.facts import Role
from kg.robot.capabilities import find
from kg.robot.capability import Capabilities
from kg.robot.connecting import connect, of_robot
from kg.robot.driving import Driver, Watchdog
from kg.robot.live import infer
from kg.robot.live.asking import Subject, running
from kg.robot.live.inference import knowledge, now
from kg.robot.programs.places import Places, offered, offers, read_places
from kg.robot.tasks import ended, first
from kg.server.robot.listeners import failure
from kg.views import evidence
from kg.views.why_tree import Telling

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.connection import ComputationGraph, Connection, GraphProblem
    from kg.settings import Settings

TOPIC: Final = "/simulator/view"
"""The topic of `kg.robot.simulation`, which is not imported here because it loads the physics engine."""
_KIND: Final = "std_msgs/String"
LARGEST: Final = 1 << 20
"""Maximum length of a picture in characters."""
_FIRST: Final = 5.0  # seconds to wait for the first picture
_UNSEEN: Final = 10.0  # seconds without a viewer after which the subscription is closed


def has_picture(graph: ComputationGraph) -> bool:
    """Return whether a simulation in a graph publishes a picture of itself."""
    return any(one.role is Role.PUBLISHES and (one.name, one.type) == (TOPIC, _KIND) for one in graph.ends)


class Picture:
    """The newest picture; call `aclose` before closing the connection."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._newest: asyncio.Future[str] | None = None
        self._task: asyncio.Task[None] | None = None
        self._seen = 0.0

    async def newest(self) -> str:
        """Return the newest picture as SVG; RobotError KG803 if none arrives."""
        self._seen = asyncio.get_running_loop().time()
        if self._task is None or self._task.done() or self._newest is None:
            self._newest = asyncio.get_running_loop().create_future()
            self._task = asyncio.create_task(self._look())
        newest, looking = self._newest, self._task
        await asyncio.wait((newest, looking), timeout=_FIRST, return_when=asyncio.FIRST_COMPLETED)
        if newest.done():
            return newest.result()
        error = looking.exception() if looking.done() and not looking.cancelled() else None
        why = f": {error.message if isinstance(error, RobotError) else error}" if error else ""
        raise RobotError("KG803", f"the simulation shows no picture{why}") from error

    async def aclose(self) -> None:
        """Close the subscription."""
        if self._task is not None:
            await ended(self._task)

    async def _look(self) -> None:
        loop = asyncio.get_running_loop()
        subscription = await self._connection.subscribe(TOPIC, _KIND, queue=1)
        try:
            async for received in subscription:
                text = received.value["data"]
                if self._newest is not None and len(text) <= LARGEST:
                    if self._newest.done():
                        self._newest = loop.create_future()
                    self._newest.set_result(text)
                if loop.time() - self._seen > _UNSEEN:
                    return
        finally:
            await subscription.aclose()


class Proofs:
    """Proofs about the last computation graph; inference runs on demand."""

    def __init__(self, address: str, settings: Settings) -> None:
        self._address = address
        self._settings = settings
        self._graph: ComputationGraph | None = None
        self._subject: tuple[ComputationGraph, Subject] | None = None
        """The last inferred subject, with its graph."""
        self._nodes: dict[str, str] = {}
        self._turn = asyncio.Lock()

    def take(self, graph: ComputationGraph | None) -> None:
        """Set the current graph; None without a connection."""
        seen, time = self._nodes, now()
        self._nodes = {node.name: seen.get(node.name, time) for node in graph.nodes} if graph else {}
        self._graph = graph

    async def why(self, name: str) -> dict[str, Any]:
        """Return `capability`, its name, and `proofs`, one tree for each node that has it, as in `kg.views.why.why`.

        Raises:
            RobotError: KG818 the robot lacks the capability, KG846 no graph yet.
        """
        async with self._turn:
            return await asyncio.to_thread(self._why, name)

    def _why(self, name: str) -> dict[str, Any]:
        graph, nodes = self._graph, self._nodes
        if graph is None:
            raise RobotError("KG846", "no robot is connected, so its capabilities cannot be explained")
        cached = self._subject  # read once: the loop may set another graph during inference
        subject = cached[1] if cached and cached[0] is graph else running(graph, self._settings, self._address, nodes)
        self._subject = graph, subject
        rules = knowledge(self._settings).rules
        telling = Telling(subject.view, rules, evidence.Places.of(()), self._settings.base)
        one = find(subject.capabilities, name)
        return {"capability": one.name, "proofs": [telling.proof(proof) for proof in subject.why(one.iri)]}


_PAUSE: Final = 2.0  # seconds between attempts to reach a robot that does not answer


class Link:
    """The state of the connection to the robot.

    `changed` is called when the state changes, `warn` when another node drives the robot, and `leave` before a driver
    is closed. `state` is `connecting`, `connected` or `lost`; `problem` is the reason if it is not connected. `places`
    are those of the settings and those reported by the robot, by name. `graph` is the computation graph. `driver` is
    set while the robot can be driven, `picture` while a simulation publishes one.
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
        """Return the driver; RobotError KG846 without a connection."""
        if self.driver is None:
            why = f": {self.problem.message}" if self.problem else ""
            raise RobotError("KG846", f"the robot at {self.address} is not connected{why}")
        return self.driver

    async def keep(self) -> None:
        """Stay connected until cancelled, despite any errors."""
        while True:
            trying = asyncio.create_task(self._connected())
            try:
                await asyncio.wait((trying,))
            finally:
                await ended(trying)
            self._be("lost" if self.state == "connected" else self.state, failure(trying, "following the robot"))
            await asyncio.sleep(_PAUSE)

    async def _connected(self) -> None:
        """Connect, and stay connected until the connection is lost; raises the reason."""
        async with AsyncExitStack() as stack:
            connection = await connect(self.address, name="/kg_page")
            stack.push_async_callback(connection.aclose)
            stack.push_async_callback(self._unseen)
            lost = await first(connection.wait_lost(), self._follow(connection))
            raise RobotError("KG803", lost[0] if lost else "the connection to the robot was lost")

    async def _follow(self, connection: Connection) -> None:
        """Update capabilities and driver when the computation graph changes."""
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
        capabilities = await asyncio.to_thread(infer, graph, self._settings, address=self.address)
        doubted = graph.problems != (self.graph.problems if self.graph else ())
        self.graph = graph
        if self.driver is None:
            watchdog = Watchdog(self.address, self._settings.watchdog)
            driver = Driver(connection, capabilities, on_problem=self._warn, watchdog=watchdog, graph=graph)
            await driver.__aenter__()
            self.driver = driver
        elif capabilities != self.capabilities:
            await self.driver.take(capabilities)
        elif not doubted:
            return
        self.capabilities = capabilities
        self._be("connected")

    async def _unseen(self) -> None:
        if (picture := self.picture) is not None:
            self.picture = None
            await picture.aclose()

    async def _give_up(self) -> None:
        if (driver := self.driver) is not None:
            try:
                await self._leave()
            finally:  # it stops the robot even if the steps before it fail or are cancelled
                self.driver = None
                await driver.__aexit__(None, None, None)

    def _be(self, state: str, problem: KgError | None = None) -> None:
        self.state, self.problem = state, problem
        self._changed()
