"""The dynamic node (onto-ros, section 3.3): capabilities are read and done by the names of their parameters."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Literal, Self, TypeAlias

from kg.errors import RobotError
from kg.robot.capability import Capabilities, Capability, Way, role_of
from kg.robot.connecting import is_recording, not_commanded, of_robot
from kg.robot.driving.arguments import given
from kg.robot.driving.doing import Command, Doing, Feedback, Parts
from kg.robot.driving.observing import MEASURED, NewestMessages, Observation, Throttle, other_controllers
from kg.robot.driving.routes import Outcome, Plan, Route, route
from kg.robot.driving.ways import choose, doubts_of, find, named
from kg.robot.lifecycle import idle, in_words
from kg.robot.tasks import finished, spawn

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Callable, Collection, Iterator, Mapping

    from kg.robot.connection import ComputationGraph, Connection, GraphProblem, Subscription
    from kg.robot.driving.watchdog import Watchdog

_QUEUE: Final = 100  # messages that may wait for a reader that is slower than the robot
_ANSWER: Final = 10.0  # seconds that a service may take to tell what is read from it
_GRAPH: Final = 1.0  # seconds of the wall that a computation graph is good for when one of several ways is chosen

_Key: TypeAlias = tuple[str, str, str, str]


class Driver:
    """What reads and does the capabilities of a robot, and stops it.

    While it is open everything that is moved goes through it, so that one place knows how to stop: on `stop`, when the
    block is left, in whatever way, and when the connection is lost, movements end with a zero command and goals are
    cancelled. It does not close the connection. What the robot can do may change while it is open: see `take`.

    Args:
        connection: the node that speaks with the robot.
        capabilities: what the robot can do.
        limit: messages a second that one topic gets at most.
        listen: seconds to wait until a subscriber is connected to a topic that is written to.
        dry_run: whether nothing is sent at all; what would be is in `Outcome.plan`.
        exclusive: whether a movement is refused, and ended, with KG829 where another node publishes to its topic.
        on_problem: is told which other node does, as KG829, where that is not refused; see `saw`.
        watchdog: what stops movements and goals when this process dies or hangs; it ends with the driver.
        graph: the computation graph that the capabilities are of, so that it is not asked for at once again.
    """

    def __init__(  # noqa: PLR0913 - what a driver can be told
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
        await self._newest.aclose()
        await self._doing.aclose()

    async def take(self, capabilities: Capabilities) -> None:
        """Go on with what the robot can do now.

        What is done or read in a way that is there no more ends with RobotError KG822, a movement with its zero
        command, a goal cancelled; it returns when they have. Everything else goes on.
        """
        self.capabilities, self._graph = capabilities, None
        self._routes.clear()
        self._parts.know(capabilities)
        ending = []
        for command, found in self._commands.items():
            if found is not None and not self._there(found):
                command.end(_vanished(found))
                ending.append(command.ended())
        readings = [one for one, found in self._readings.items() if not self._there(found)]
        topics = {way.name for one in capabilities.capabilities if one.modality == "read" for way in one.ways}
        await asyncio.gather(*ending, *(one.aclose() for one in readings), self._newest.keep(topics))

    async def _watch_connection(self) -> None:
        self._lost = await self.connection.wait_lost()
        for command in list(self._commands):
            command.end(self._gone("the driver is closed"))

    def _gone(self, otherwise: str) -> RobotError:
        """Return the error KG803 with the reason why the connection is lost, or with another where it is not."""
        if self._lost is None:
            return RobotError("KG803", otherwise)
        return RobotError("KG803", f"the robot at {self.connection.address} is lost: {self._lost}")

    async def read(
        self, capability: str, *, way: str | None = None, rate: float | None = None
    ) -> AsyncGenerator[dict[str, Any], None]:
        """Yield the values of a capability by parameter: of each message, at most `rate` a second.

        It ends with the recording where one is played. A service is called once; where `rate` is given, so often a
        second. None stands for what a message does not say
        (NaN, the first of an empty list); a reading of a scan that is free is infinite.

        Raises:
            RobotError: KG819 when no node of the way is active, KG821 or KG822 when there is no such capability or way,
                KG803 when the robot is lost, KG804 or KG826 when its messages are not understood, and those of a
                service.
        """
        found = await self._route(capability, "read", way)
        if found.way.kind == "service":
            yield await self._ask(found)
            while rate:
                await self.connection.clock.sleep(1 / rate)
                yield await self._ask(found)
            return
        subscription = await self.connection.subscribe(found.way.name, found.way.type, queue=_QUEUE)
        throttle = Throttle(rate)
        self._readings[subscription] = found
        try:
            if self._closed or not self._there(found):  # it has come too late to be ended by `take`
                await subscription.aclose()
            async for received in subscription:
                if throttle.takes(received.at):
                    yield found.values(received.value)
        finally:
            del self._readings[subscription]
            await subscription.aclose()
        if not self._closed and not is_recording(self.connection.address):
            raise await self._ended(found)

    async def latest(self, capability: str, *, seconds: float = 5.0, way: str | None = None) -> dict[str, Any]:
        """Return the newest values of a capability; it waits for the first, and listens on from then.

        `seconds` are of the wall: connecting takes as long however fast a simulation runs.

        Raises:
            RobotError: those of `read`; KG825 when nothing came in time.
        """
        found = await self._route(capability, "read", way)
        if found.way.kind == "service":
            return await self._ask(found)
        try:
            async with asyncio.timeout(seconds):
                following = await self._newest.of(found.way.name, found.way.type)
                newest = await following.first()
        except TimeoutError:
            raise RobotError("KG825", f"no message from `{found.way.name}` within {seconds:g} s") from None
        if newest is None or following.ended:
            raise await self._ended(found)
        return found.values(newest.value)

    async def changes(self, capability: str, *, asked: float) -> AsyncGenerator[None, None]:
        """Yield whenever `latest` may tell something else: with each message that it has from then, and with the first.

        That of a service is to be asked for `asked` times a second. RobotError as `read`.
        """
        found = await self._route(capability, "read", None)
        while found.way.kind == "service":
            yield
            await self.connection.clock.sleep(1 / asked)
        following = await self._newest.of(found.way.name, found.way.type)
        told = None
        while self._there(found) and not following.ended:
            if following.newest is told:
                await following.news()
            else:
                told = following.newest
                yield
        if not self._closed:
            raise await self._ended(found)

    async def _ask(self, found: Route) -> dict[str, Any]:
        request = found.message({}, self.connection.clock.now())
        return found.answer(await self.connection.call(found.way.name, found.way.type, request, seconds=_ANSWER))

    async def _ended(self, found: Route) -> RobotError:
        await asyncio.sleep(0)  # who watches the connection may know why in a moment
        if self._lost is None and not self._there(found):
            return _vanished(found)
        return self._gone(f"`{found.way.name}` has ended")

    async def doubts(
        self, capability: str, modality: Literal["read", "write"], *, way: str | None = None
    ) -> tuple[GraphProblem, ...]:
        """Return why reading or doing something may come to nothing, as `kg.robot.driving.ways` has it.

        Nodes that are dead and still registered, or a topic that nobody listens to, are worth a word before what is
        sent there, or is waited for, is missed. RobotError KG821 or KG822 when there is no such capability or way.
        """
        found = await self._route(capability, modality, way)
        graph = await self._seen()
        return () if graph is None else tuple(doubts_of(found.way, graph, reads=modality == "read"))

    async def plan(
        self,
        capability: str,
        arguments: Mapping[str, Any] | None = None,
        *,
        seconds: float | None = None,
        way: str | None = None,
    ) -> Plan:
        """Return what `do` would send where; errors as those of `do` that need no robot."""
        return self._plan(await self._route(capability, "write", way, arguments or ()), arguments or {}, seconds)

    async def do(  # noqa: PLR0913 - what a command can say
        self,
        capability: str,
        arguments: Mapping[str, Any] | None = None,
        *,
        seconds: float | None = None,
        way: str | None = None,
        on_feedback: Feedback | None = None,
        dry_run: bool = False,
    ) -> Outcome:
        """Do something, and return when it is done.

        A movement is renewed for `seconds`, without them until something else ends it, and then gets a zero command. A
        goal is given up when it is not reached in `seconds`. Anything else is sent once. Whatever ends it (a deadline,
        a cancellation, an error, a later command, `stop`, a lost connection), a movement gets its zero command and a
        goal is cancelled.

        Args:
            capability: its name, label or alternative label.
            arguments: values by parameter: numbers in the parameter's unit, or texts (`30cm`, `45deg/s`, `true`).
            seconds: of the robot's time.
            way: the channel, node or message type to use where there are several.
            on_feedback: told how far an action is.
            dry_run: whether to say what would be sent instead.

        Raises:
            RobotError: KG819, KG821 to KG823, KG826 and KG827 before anything is sent; KG805, KG807 to KG809 from the
                robot; KG824 when nobody listens, KG825 when a goal is not reached in time, KG803 when the robot is
                lost.
        """
        command = Command()
        self._commands[command] = None
        try:
            found = self._commands[command] = await self._route(capability, "write", way, arguments or ())
            plan = self._plan(found, arguments or {}, seconds)
            if dry_run or self._dry_run:
                return Outcome(plan=plan, ended="planned")
            values = given(found.capability, arguments or {})
            return await self._carry_out(command, found, plan, values, on_feedback)
        finally:
            del self._commands[command]

    async def _carry_out(
        self, command: Command, found: Route, plan: Plan, arguments: Mapping[str, Any], on_feedback: Feedback | None
    ) -> Outcome:
        if self._lost is not None or self._closed:
            raise self._gone("the driver is closed")
        if found.moves:
            graph = await self.connection.graph() if self._exclusive else self._whole
            if graph is not None and (error := self._contested(found, graph)) is not None:
                raise error
        observation = Observation(arguments)
        observing = list(self._observe(observation, found)) if found.moves else []
        try:
            values = await command.begin(self._doing.carry_out(command, found, plan, on_feedback))
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

    def _observe(self, observation: Observation, found: Route) -> Iterator[asyncio.Task[None]]:
        """Begin to compare what the robot does with what it is told, by all that measures that."""
        for one in self.capabilities.capabilities:
            for way in one.ways if one.name in MEASURED and one.modality == "read" else ():
                if way.kind == "topic" and self._parts.may_be_one_robot(way.node, found.way.node):
                    with suppress(RobotError):  # a path that does not fit is an error of who reads it
                        watching = observation.watch(self._ready(one, way), self._newest, self.connection.clock)
                        yield spawn(watching, "watching whether the robot moves")

    def _plan(self, found: Route, arguments: Mapping[str, Any], seconds: float | None) -> Plan:
        now, types = self.connection.clock.now(), self.connection.types
        message = found.message(given(found.capability, arguments), now)
        timed = found.moves or found.way.kind != "topic"
        return Plan(
            capability=found.capability.name,
            kind=found.way.kind,
            name=found.way.name,
            type=found.way.type,
            node=found.way.node,
            message=types.complete(found.sends, message),
            rate=found.way.rate if found.moves else 0,
            seconds=seconds if timed else None,
            afterwards=types.complete(found.sends, found.zero(now)) if found.moves else None,
        )

    async def stop(self) -> None:
        """Stop the robot: end all commands, send zero commands to all that was ever moved, cancel all goals."""
        await asyncio.shield(asyncio.ensure_future(self._stop()))

    async def _stop(self) -> None:
        commands = list(self._commands)
        for command in commands:
            command.end("stopped")
        await self._doing.still(again=True)
        await asyncio.gather(*(command.ended() for command in commands))

    def saw(self, graph: ComputationGraph) -> None:
        """Take the computation graph that the connection tells: nodes that drive the same are reported, or end that."""
        self._whole = graph
        for command, found in self._commands.items():
            if found is not None and found.moves and (error := self._contested(found, graph)) is not None:
                command.end(error)

    def _contested(self, found: Route, graph: ComputationGraph) -> RobotError | None:
        """Report new nodes that publish to the topic of a movement; where it is exclusive, return them as an error."""
        others = set(other_controllers(found.way.name, graph))
        if others and self._exclusive:
            names = ", ".join(f"`{one.subject}`" for one in sorted(others))
            return RobotError("KG829", f"{names} publishes to `{found.way.name}`, which was to be driven exclusively")
        for one in sorted(others - self._others):
            self._on_problem(one)
        self._others = others
        return None

    def interrupt(self, error: RobotError) -> None:
        """End all movements and goals with an error; programs that run on this driver end with it, too.

        The robot must not go on by itself after its controller stood still, since nobody knows what happened meanwhile.
        """
        self._interruption.set_result(error)
        self._interruption = asyncio.get_running_loop().create_future()
        for command, found in self._commands.items():
            if found is not None and (found.moves or found.way.kind == "action"):
                command.end(error)

    async def wait_interrupted(self) -> RobotError:
        """Return the error of the next interruption."""
        return await asyncio.shield(self._interruption)

    async def _route(
        self, name: str, modality: Literal["read", "write"], way: str | None, arguments: Collection[str] = ()
    ) -> Route:
        if modality == "write" and is_recording(self.connection.address):
            raise not_commanded(self.connection.address)
        known = None
        while known is not self.capabilities:  # others may be taken while the graph is asked
            known = self.capabilities
            capability = find(known, name, modality)
            ways = named(capability, way)
            if modality == "read":
                ways = [one for one in ways if one.kind != "action"]
                if not ways:
                    raise RobotError("KG822", f"`{capability.name}` is only reported while its action runs")
            managed = self.connection.ros == 2  # noqa: PLR2004 - the version whose nodes have a life cycle
            graph = await self._seen() if managed or len(ways) > 1 else None
        chosen = choose(ways, arguments, graph, reads=modality == "read")
        if graph is not None and (nodes := idle(graph, chosen.name, role_of(chosen, reads=modality == "read"))):
            raise RobotError("KG819", f"`{capability.name}` is not available now: {in_words(nodes)}")
        return self._ready(capability, chosen)

    def _ready(self, capability: Capability, way: Way) -> Route:
        key = _key(capability, way)
        if key not in self._routes:
            self._routes[key] = route(capability, way, self.connection.types)
        return self._routes[key]

    def _there(self, found: Route) -> bool:
        """Tell whether the robot can still do, or tell, something in a way."""
        key = _key(found.capability, found.way)
        return any(key == _key(one, way) for one in self.capabilities.capabilities for way in one.ways)

    async def _seen(self) -> ComputationGraph | None:
        now = asyncio.get_running_loop().time()
        if self._graph is None or now - self._graph[0] > _GRAPH:
            try:
                self._graph = (now, of_robot(await self.connection.graph()))
            except RobotError:
                self._graph = (now, None)  # all ways count as alive then
        return self._graph[1]


def _key(capability: Capability, way: Way) -> _Key:
    """Return what tells ways apart; the node does not, for another may take its place."""
    return capability.iri, way.kind, way.name, way.type


def _vanished(found: Route) -> RobotError:
    """Return the error KG822 for what was done, or read, in a way that is there no more."""
    does = "provides" if found.capability.modality == "write" else "reports"
    message = f"no node of the robot {does} `{found.capability.name}` through `{found.way.name}` any more"
    return RobotError("KG822", message, hint=f"`{found.way.node}` did; start it again.")
