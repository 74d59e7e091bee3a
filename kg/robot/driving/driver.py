"""The dynamic node (onto-ros, section 3.3): reads and executes capabilities by the names of their parameters."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Literal, Self, TypeAlias

from kg.errors import RobotError
from kg.robot.capability import Capabilities, Capability, Way, role_of
from kg.robot.connecting import is_recording, lost, not_commanded, of_robot
from kg.robot.driving.arguments import given
from kg.robot.driving.doing import Command, Doing, Feedback, Parts
from kg.robot.driving.observing import MEASURED, NewestMessages, Observation, Throttle, other_controllers
from kg.robot.driving.routes import Outcome, Plan, Route, route
from kg.robot.driving.ways import choose, doubts_of, find, named
from kg.robot.lifecycle import idle, in_words
from kg.robot.tasks import finished, spawn

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Callable, Collection, Iterator, Mapping

    from kg.robot.connection import ComputationGraph, Connection, GraphProblem, Level, Subscription
    from kg.robot.driving.watchdog import Watchdog

_QUEUE: Final = 100  # maximum number of messages queued for a slow reader
_ANSWER: Final = 10.0  # timeout in seconds of a service that is read
_GRAPH: Final = 1.0  # wall-clock seconds for which a computation graph is reused to choose an interface

_Key: TypeAlias = tuple[str, str, str, str]


class Driver:
    """Reads and executes the capabilities of a robot, and stops it.

    While it is open, all movements go through it, so one place can stop them: on `stop`, on exit for any reason, and on
    a lost connection, movements end with a zero command and goals are cancelled. It does not close the connection. The
    capabilities of the robot may change while it is open: see `take`.

    Args:
        connection: the node that communicates with the robot.
        capabilities: those of the robot.
        limit: maximum messages per second on one topic.
        listen: seconds to wait for a subscriber of a topic.
        dry_run: send nothing; `Outcome.plan` has what would be sent.
        exclusive: refuse and end movements with KG829 if another node publishes to their topic.
        on_problem: receives KG829 about such nodes otherwise; see `saw`.
        watchdog: stops movements and goals if this process dies or hangs; it ends with the driver.
        graph: the computation graph of the capabilities, to avoid reading it again at once.
    """

    def __init__(  # noqa: PLR0913 - the options of a driver
        self,
        connection: Connection,
        capabilities: Capabilities,
        *,
        limit: float = 200.0,
        listen: float = 3.0,
        dry_run: bool = False,
        exclusive: bool = False,
        on_problem: Callable[[GraphProblem], None] = lambda _: None,
        watchdog: Watchdog | None = None,
        graph: ComputationGraph | None = None,
    ) -> None:
        self.connection = connection
        self.capabilities = capabilities
        self._dry_run = dry_run
        self._exclusive = exclusive
        self._on_problem = on_problem
        self._whole: ComputationGraph | None = None
        self._others: set[GraphProblem] = set()
        self._watchdog = watchdog
        self._interruption: asyncio.Future[RobotError] = asyncio.get_running_loop().create_future()
        self._parts = Parts(capabilities)
        self._doing = Doing(connection, self._parts, watchdog, limit=limit, listen=listen)
        self._newest = NewestMessages(connection)
        self._routes: dict[_Key, Route] = {}
        self._graph: tuple[float, ComputationGraph | None] | None
        self._graph = None if graph is None else (asyncio.get_running_loop().time(), graph)
        self._commands: dict[Command, Route | None] = {}
        self._readings: dict[Subscription, Route] = {}
        self._lost: str | None = None
        self._closed = False
        self._watch: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Self:
        self._watch = spawn(self._watch_connection(), "watching the connection")
        if self._watchdog is not None:
            self._watchdog.open(self.interrupt)
        return self

    async def __aexit__(self, *_: object) -> None:
        await finished(self._close())

    async def _close(self) -> None:
        self._closed = True
        if self._watch is not None:
            self._watch.cancel()
        await self.stop()
        await asyncio.gather(*(one.aclose() for one in self._readings))
        await self._newest.keep(())
        await self._doing.aclose()

    async def take(self, capabilities: Capabilities) -> None:
        """Set the robot's current capabilities.

        Commands and readings over interfaces that are gone end with RobotError KG822: movements with a zero command,
        goals by cancellation. It returns after that. Others continue.
        """
        self.capabilities, self._graph = capabilities, None
        self._routes.clear()
        self._parts.know(capabilities)
        ending = []
        for command, chosen in self._commands.items():
            if chosen is not None and not self._is_offered(chosen):
                command.end(_vanished(chosen))
                ending.append(command.ended())
        readings = [one for one, chosen in self._readings.items() if not self._is_offered(chosen)]
        topics = {way.name for one in capabilities.capabilities if one.modality == "read" for way in one.ways}
        await asyncio.gather(*ending, *(one.aclose() for one in readings), self._newest.keep(topics))

    async def _watch_connection(self) -> None:
        self._lost = await self.connection.wait_lost()
        self._doing.lost = True
        for command in list(self._commands):
            command.end(self._lost_error("the driver is closed"))

    def _lost_error(self, otherwise: str) -> RobotError:
        """Return the error KG803 with the reason of the lost connection, or with another one while it is open."""
        if self._lost is None:
            return RobotError("KG803", otherwise)
        return lost(self.connection.address, self._lost)

    async def read(
        self, capability: str, *, way: str | None = None, rate: float | None = None
    ) -> AsyncGenerator[dict[str, Any], None]:
        """Yield the values of a capability by parameter: those of each message, at most `rate` per second.

        On a recording, it ends with the recording. A service is called once, or `rate` times per second. None is a
        value missing from a message (NaN, the first of an empty list); a scan without an obstacle is infinite.

        Raises:
            RobotError: KG819 no node of the interface is active, KG821 or KG822 no such capability or interface, KG803
                the connection is lost, KG804 or KG826 its messages cannot be decoded, and those of a service.
        """
        chosen = await self._route(capability, "read", way)
        if chosen.way.kind == "service":
            yield await self._ask(chosen)
            while rate:
                await self.connection.clock.sleep(1 / rate)
                yield await self._ask(chosen)
            return
        subscription = await self.connection.subscribe(chosen.way.name, chosen.way.type, queue=_QUEUE)
        throttle = Throttle(rate)
        self._readings[subscription] = chosen
        try:
            if self._closed or not self._is_offered(chosen):  # it came too late for `take` to end it
                await subscription.aclose()
            async for received in subscription:
                if throttle.takes(received.at):
                    yield chosen.values(received.value)
        finally:
            del self._readings[subscription]
            await subscription.aclose()
        if not self._closed and not is_recording(self.connection.address):
            raise await self._ended(chosen)

    async def latest(self, capability: str, *, seconds: float = 5.0) -> dict[str, Any]:
        """Return the newest values of a capability; the first call waits for a message and subscribes.

        `seconds` are wall-clock time: connecting takes as long however fast a simulation runs.

        Raises:
            RobotError: those of `read`; KG825 no message in time.
        """
        chosen = await self._route(capability, "read", None)
        if chosen.way.kind == "service":
            return await self._ask(chosen)
        try:
            async with asyncio.timeout(seconds):
                following = await self._newest.of(chosen.way.name, chosen.way.type)
                newest = await following.first()
        except TimeoutError:
            raise RobotError("KG825", f"no message from `{chosen.way.name}` within {seconds:g} s") from None
        if newest is None or following.ended:
            raise await self._ended(chosen)
        return chosen.values(newest.value)

    async def changes(self, capability: str, *, rate: float) -> AsyncGenerator[None, None]:
        """Yield whenever `latest` may return another value: with the first message and each later one.

        A service is called `rate` times per second. RobotError as `read`.
        """
        chosen = await self._route(capability, "read", None)
        while chosen.way.kind == "service":
            yield
            await self.connection.clock.sleep(1 / rate)
        following = await self._newest.of(chosen.way.name, chosen.way.type)
        last = None
        while self._is_offered(chosen) and not following.ended:
            if following.newest is last:
                await following.news()
            else:
                last = following.newest
                yield
        if not self._closed:
            raise await self._ended(chosen)

    async def _ask(self, chosen: Route) -> dict[str, Any]:
        request = chosen.message({}, self.connection.clock.now())
        return chosen.answer(await self.connection.call(chosen.way.name, chosen.way.type, request, seconds=_ANSWER))

    async def _ended(self, chosen: Route) -> RobotError:
        await asyncio.sleep(0)  # the watcher of the connection may report the reason
        if self._lost is None and not self._is_offered(chosen):
            return _vanished(chosen)
        return self._lost_error(f"`{chosen.way.name}` has ended")

    async def doubts(
        self, capability: str, modality: Literal["read", "write"], *, way: str | None = None
    ) -> tuple[GraphProblem, ...]:
        """Return why a reading or command might have no effect, as in `kg.robot.driving.ways`.

        For example, nodes are dead but registered, or a topic has no subscriber. Callers report this before they send
        or wait. RobotError KG821 or KG822 if there is no such capability or interface.
        """
        chosen = await self._route(capability, modality, way)
        graph = await self._recent_graph()
        return () if graph is None else tuple(doubts_of(chosen.way, graph, reads=modality == "read"))

    async def plan(
        self,
        capability: str,
        arguments: Mapping[str, Any] | None = None,
        *,
        seconds: float | None = None,
        way: str | None = None,
    ) -> Plan:
        """Return what `do` would send; errors as those of `do` that need no robot."""
        chosen = await self._route(capability, "write", way, arguments or ())
        return self._plan(chosen, given(chosen.capability, arguments or {}), seconds)

    async def do(
        self,
        capability: str,
        arguments: Mapping[str, Any] | None = None,
        *,
        seconds: float | None = None,
        way: str | None = None,
        on_feedback: Feedback | None = None,
    ) -> Outcome:
        """Execute a capability, and return when it is done.

        A movement is repeated for `seconds`, or until something else ends it, and then gets a zero command. A goal is
        cancelled if it is not reached within `seconds`. Anything else is sent once. Whatever ends it (timeout,
        cancellation, error, a later command, `stop`, a lost connection), a movement gets its zero command and a goal is
        cancelled.

        Args:
            capability: its name, label or alternative label.
            arguments: values by parameter: numbers in the parameter's unit, or texts (`30cm`, `45deg/s`, `true`).
            seconds: of the robot's time.
            way: the channel, node or message type, if there are several interfaces.
            on_feedback: receives the progress of an action.

        Raises:
            RobotError: KG819, KG821 to KG823, KG826 and KG827 before anything is sent; KG805, KG807 to KG809 from the
                robot; KG824 no subscriber, KG825 a goal is not reached in time, KG803 the connection is lost.
        """
        command = Command()
        self._commands[command] = None
        try:
            chosen = self._commands[command] = await self._route(capability, "write", way, arguments or ())
            values = given(chosen.capability, arguments or {})
            plan = self._plan(chosen, values, seconds)
            if self._dry_run:
                return Outcome(plan=plan, ended="planned")
            return await self._carry_out(command, chosen, plan, values, on_feedback)
        finally:
            del self._commands[command]

    async def _carry_out(
        self, command: Command, chosen: Route, plan: Plan, commanded: Mapping[str, Any], on_feedback: Feedback | None
    ) -> Outcome:
        if self._lost is not None or self._closed:
            raise self._lost_error("the driver is closed")
        if chosen.moves:
            graph = await self.connection.graph() if self._exclusive else self._whole
            if graph is not None and (error := self._contested(chosen, graph)) is not None:
                raise error
        observation = Observation(commanded)
        observing = list(self._observe(observation, chosen)) if chosen.moves else []
        try:
            values = await command.begin(self._doing.carry_out(command, chosen, plan, on_feedback))
        except (asyncio.CancelledError, RobotError):
            task, ending = asyncio.current_task(), command.ending
            if ending is None or (task is not None and task.cancelling()):
                raise
            if isinstance(ending, RobotError):
                raise ending from None
            return Outcome(plan=plan, ended=ending, sent=command.sent)
        finally:
            for one in observing:
                one.cancel()
        return Outcome(plan=plan, ended="done", values=values, sent=command.sent, moved=observation.moved)

    def _observe(self, observation: Observation, chosen: Route) -> Iterator[asyncio.Task[None]]:
        """Compare the commanded with the measured movement, by all capabilities that measure it."""
        for one in self.capabilities.capabilities:
            for way in one.ways if one.name in MEASURED and one.modality == "read" else ():
                if way.kind == "topic" and self._parts.may_be_one_robot(way.node, chosen.way.node):
                    with suppress(RobotError):  # a path that does not fit is an error of its reader
                        watching = observation.watch(self._ready(one, way), self._newest, self.connection.clock)
                        yield spawn(watching, "watching whether the robot moves")

    def _plan(self, chosen: Route, values: Mapping[str, Any], seconds: float | None) -> Plan:
        now, types = self.connection.clock.now(), self.connection.types
        timed = chosen.moves or chosen.way.kind != "topic"
        return Plan(
            capability=chosen.capability.name,
            kind=chosen.way.kind,
            name=chosen.way.name,
            type=chosen.way.type,
            node=chosen.way.node,
            message=types.complete(chosen.way.sent, chosen.message(values, now)),
            rate=chosen.way.rate if chosen.moves else 0,
            seconds=seconds if timed else None,
            afterwards=types.complete(chosen.way.sent, chosen.zero(now)) if chosen.moves else None,
        )

    async def stop(self, *, released: bool = False) -> None:
        """Stop the robot: end all commands, send zero to every topic that ever moved, cancel all goals.

        Topics that were released get zero only with `released`: another client may drive the robot by them.
        """
        await asyncio.shield(asyncio.ensure_future(self._stop(released=released)))

    async def release(self, seconds: float) -> None:
        """Stop publishing topics that stopped some seconds ago, if their subscribers have confirmed it."""
        await self._doing.release(seconds)

    async def _stop(self, *, released: bool) -> None:
        commands = list(self._commands)
        for command in commands:
            command.end("stopped")
        await self._doing.still(released=released)
        await asyncio.gather(*(command.ended() for command in commands))

    def log(self, level: Level, message: str) -> None:
        """Write a line to the log of the robot, except in a dry run."""
        if not self._dry_run:
            self.connection.log(level, message)

    def saw(self, graph: ComputationGraph) -> None:
        """Set the current computation graph: other controllers are reported, or end the movement."""
        self._whole = graph
        for command, chosen in self._commands.items():
            if chosen is not None and chosen.moves and (error := self._contested(chosen, graph)) is not None:
                command.end(error)

    def _contested(self, chosen: Route, graph: ComputationGraph) -> RobotError | None:
        """Report new nodes that publish to the topic of a movement; if it is exclusive, return them as an error."""
        others = set(other_controllers(chosen.way.name, graph))
        if others and self._exclusive:
            names = ", ".join(f"`{one.subject}`" for one in sorted(others))
            return RobotError("KG829", f"{names} publishes to `{chosen.way.name}`, which was to be driven exclusively")
        for one in sorted(others - self._others):
            self.log("warning", f"[{one.code}] {one.subject}: {one.message}")
            self._on_problem(one)
        self._others = others
        return None

    def interrupt(self, error: RobotError) -> None:
        """End all movements and goals with an error; programs on this driver end with it too.

        After its controller was suspended, the robot must not continue by itself, since its state is unknown.
        """
        self._interruption.set_result(error)
        self._interruption = asyncio.get_running_loop().create_future()
        for command, chosen in self._commands.items():
            if chosen is not None and (chosen.moves or chosen.way.kind == "action"):
                command.end(error)

    async def wait_interrupted(self) -> RobotError:
        """Return the error of the next interruption."""
        return await asyncio.shield(self._interruption)

    async def _route(
        self, name: str, modality: Literal["read", "write"], way: str | None, arguments: Collection[str] = ()
    ) -> Route:
        if modality == "write" and is_recording(self.connection.address):
            raise not_commanded(self.connection.address)
        current = None
        while current is not self.capabilities:  # others may take over while the graph is read
            current = self.capabilities
            capability = find(current, name, modality)
            ways = named(capability, way)
            if modality == "read":
                ways = [one for one in ways if one.kind != "action"]
                if not ways:
                    raise RobotError("KG822", f"`{capability.name}` is only reported while its action runs")
            managed = self.connection.ros == 2  # noqa: PLR2004 - the version whose nodes have a life cycle
            graph = await self._recent_graph() if managed or len(ways) > 1 else None
        chosen = choose(ways, arguments, graph, reads=modality == "read")
        if graph is not None and (nodes := idle(graph, chosen.name, role_of(chosen, reads=modality == "read"))):
            raise RobotError("KG819", f"`{capability.name}` is not available now: {in_words(nodes)}")
        return self._ready(capability, chosen)

    def _ready(self, capability: Capability, way: Way) -> Route:
        key = _key(capability, way)
        if key not in self._routes:
            self._routes[key] = route(capability, way, self.connection.types)
        return self._routes[key]

    def _is_offered(self, chosen: Route) -> bool:
        key = _key(chosen.capability, chosen.way)
        return any(key == _key(one, way) for one in self.capabilities.capabilities for way in one.ways)

    async def _recent_graph(self) -> ComputationGraph | None:
        now = asyncio.get_running_loop().time()
        if self._graph is None or now - self._graph[0] > _GRAPH:
            try:
                self._graph = (now, of_robot(await self.connection.graph()))
            except RobotError:
                self._graph = (now, None)  # all interfaces count as alive then
        return self._graph[1]


def _key(capability: Capability, way: Way) -> _Key:
    """Return the key of an interface, without the node, which another one may replace."""
    return capability.iri, way.kind, way.name, way.type


def _vanished(chosen: Route) -> RobotError:
    """Return the error KG822 for a command or reading over an interface that is gone."""
    does = "provides" if chosen.capability.modality == "write" else "reports"
    message = f"no node of the robot {does} `{chosen.capability.name}` through `{chosen.way.name}` any more"
    return RobotError("KG822", message, hint=f"`{chosen.way.node}` did; start it again.")
