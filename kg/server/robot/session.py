"""One robot for all open pages: its capabilities with reasons, programs, driving by hand, and stopping."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Self

import msgspec

from kg.errors import KgError, RobotError
from kg.robot.driving.ways import find
from kg.robot.programs.places import placed
from kg.robot.tasks import ended, spawn
from kg.server.addresses import url
from kg.server.errors import problem
from kg.server.robot.judging import Robot
from kg.server.robot.link import Link
from kg.server.robot.listeners import MOST, Listener, Listeners
from kg.server.robot.work import Hands, Readings, Running

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.robot.capability import Capabilities, Capability
    from kg.robot.connection import GraphProblem
    from kg.robot.programs.tree import Program
    from kg.settings import Settings

_WORDS: Final = {
    ("topic", "write"): "Its node `{node}` subscribes to `{name}` (`{type}`).",
    ("topic", "read"): "Its node `{node}` publishes it to `{name}` (`{type}`).",
    ("service", "write"): "Its node `{node}` does it through the service `{name}` (`{type}`).",
    ("service", "read"): "Its node `{node}` reports it through the service `{name}` (`{type}`).",
    ("action", "write"): "Its node `{node}` accepts goals for it through the action `{name}` (`{type}`).",
    ("action", "read"): "Its node `{node}` reports it while it executes the action `{name}` (`{type}`).",
}


def described(capability: Capability) -> dict[str, Any]:
    """Return a capability in the format of the page: its members, and `because`, the reasons."""
    members: dict[str, Any] = msgspec.to_builtins(capability)
    empty: dict[str, Any] = {"comment": "", "kinds": (), "parameters": (), "ways": ()}
    reasons = (
        _WORDS[way.kind, capability.modality].format(node=way.node, name=way.name, type=way.type)
        for way in capability.ways
    )
    return {**empty, **members, "because": list(dict.fromkeys(reasons))}


_FRAME: Final = 0.25  # seconds between two pictures from above
_LOOK: Final = 1.0  # seconds between checks for unused topics
_UNUSED: Final = 5.0  # seconds after which a topic counts as unused: driving by hand has shorter pauses
_LAST: Final = 3.0  # seconds allowed for stopping the robot before the server exits anyway


class Session:
    """One robot for all viewers; `async with` connects and finally stops the robot."""

    def __init__(self, address: str, settings: Settings) -> None:
        self.listeners = Listeners()
        self._link = Link(address, settings, self._changed, self._warn, self._still)
        self._hands = Hands(self.listeners)
        self._readings = Readings(self.listeners)
        self._running = Running(self.listeners)
        self._tasks: list[asyncio.Task[None]] = []

    async def __aenter__(self) -> Self:
        self._tasks = [
            spawn(self._link.keep(), "staying connected to the robot"),
            spawn(self._hands.watch(), "watching manual driving"),
            spawn(self._show(), "showing the robot from above"),
            spawn(self._release(), "releasing unused topics"),
        ]
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.leave()
        await ended(*self._tasks)

    @property
    def address(self) -> str:
        """The address of the robot."""
        return self._link.address

    @property
    def capabilities(self) -> Capabilities | None:
        """The capabilities of the robot; None while unknown."""
        return self._link.capabilities if self._link.state == "connected" else None

    @property
    def robot(self) -> Robot | None:
        """The context for checking programs; None while unknown."""
        capabilities, graph = self.capabilities, self._link.graph
        return None if capabilities is None or graph is None else Robot(capabilities, self._link.places, graph)

    def status(self) -> dict[str, Any]:
        """Return the state of the robot in the format of the page."""
        link = self._link
        return {
            "address": link.address,
            "state": link.state,
            "problem": problem(link.problem) if link.problem else None,
            "capabilities": [described(one) for one in link.capabilities.capabilities],
            "places": msgspec.to_builtins(link.places),
            "doubts": [f"{one.subject}: {one.message}" for one in link.graph.problems] if link.graph else [],
            "program": self._running.status(),
            "view": url("/robot/view") if link.picture else None,
        }

    async def view(self) -> str:
        """Return the robot from above as SVG; RobotError KG846 without a simulation that publishes it."""
        if self._link.picture is None:
            raise RobotError("KG846", "no simulation shows itself", hint="Only `kg robot simulate` does.")
        return await self._link.picture.newest()

    async def why(self, name: str) -> dict[str, Any]:
        """Return the proofs of a capability; see `kg.server.robot.link.Proofs.why`."""
        return await self._link.proofs.why(name)

    async def run(self, program: Program) -> None:
        """Run a program; RobotError KG846 without a robot, KG847 while something else runs."""
        driver = self._link.needed()
        if self._running.active:
            raise RobotError("KG847", "a program runs already", hint="Stop it, or wait until it has ended.")
        if self._hands.busy:
            raise RobotError("KG847", "the robot is driven by hand", hint="Stop that, or wait until it has ended.")
        self._running.start(driver, placed(program, self._link.places))

    async def pause(self) -> None:
        """Pause the program, if one runs."""
        self._running.pause()

    async def resume(self) -> None:
        """Resume the program, if one is paused."""
        self._running.resume()

    def do(self, identity: str, name: str, arguments: Mapping[str, Any], seconds: float | None) -> None:
        """Execute a capability by hand, for an open page.

        Raises:
            RobotError: KG821 and KG822 the robot lacks the capability, KG846 no robot, KG847 a program runs, KG848 the
                duration is too long, KG849 the page is not open.
        """
        listener, driver = self.listener(identity), self._link.needed()
        if self._running.active:
            raise RobotError("KG847", "a program runs", hint="Stop it first.")
        self._hands.do(driver, listener, find(self._link.capabilities, name, "write"), arguments, seconds)

    def here(self, identity: str) -> None:
        """Record a sign of life of a page; RobotError KG849 if it is not open."""
        self.listener(identity).last_beat = asyncio.get_running_loop().time()

    def follow(self, identity: str, names: Iterable[str]) -> None:
        """Set the values that a page follows; RobotError KG821 if one is unreadable, KG849 if the page is not open."""
        listener = self.listener(identity)
        listener.reads = frozenset(find(self._link.capabilities, name, "read").name for name in names)
        self._readings.follow(self._link.needed())

    async def stop(self, *, released: bool = True) -> None:
        """Stop all movements, whoever started them; `released` as in `Driver.stop`."""
        await self._still()
        if self._link.driver is not None:
            await self._link.driver.stop(released=released)

    async def suspend(self) -> None:
        """Stop all movements with KG828, within a few seconds, before the process is suspended."""
        if (driver := self._link.driver) is not None:
            driver.interrupt(RobotError("KG828", "Ctrl-Z suspended the server, and the robot was stopped"))
            with suppress(TimeoutError):
                async with asyncio.timeout(_LAST):
                    await driver.stop()

    def listen(self) -> Listener:
        """Return a new open page; RobotError KG847 if there are too many."""
        if len(self.listeners) >= MOST:
            raise RobotError("KG847", f"{MOST} pages look on already", hint="Close one of them.")
        return self.listeners.add()

    async def gone(self, listener: Listener) -> None:
        """Remove a closed page and stop its movements."""
        self.listeners.remove(listener)
        self._readings.follow(self._link.driver)
        await self._hands.stop({listener})

    def listener(self, identity: str) -> Listener:
        """Return an open page; RobotError KG849 if it is not open."""
        page = self.listeners.get(identity)
        if page is None:
            raise RobotError("KG849", "the page that asks this is not listening to the robot")
        return page

    async def leave(self) -> None:
        """Stop the robot and end the streams of pages, within a few seconds in any case."""
        self.listeners.close()
        with suppress(TimeoutError):  # the rest of stopping continues while the connection is closed
            async with asyncio.timeout(_LAST):
                await self.stop(released=False)
                await self._readings.aclose()

    async def _show(self) -> None:
        """Send the view from above to pages when it changes, while pages are visible."""
        while True:
            await asyncio.sleep(_FRAME)
            if not self.listeners or self._link.picture is None:
                continue
            with suppress(KgError):
                self.listeners.show(await self._link.picture.newest())

    async def _release(self) -> None:
        """Stop publishing topics that are not used, so other clients can drive the robot exclusively."""
        while True:
            await asyncio.sleep(_LOOK)
            if self._link.driver is not None and not self._running.active:
                await self._link.driver.release(_UNUSED)

    def _changed(self) -> None:
        self._readings.follow(self._link.driver)
        self.listeners.publish({"event": "robot"})

    def _warn(self, problem: GraphProblem) -> None:
        message = f"warning[{problem.code}]: {problem.subject}: {problem.message}"
        self.listeners.publish({"event": "step", "log": message})

    async def _still(self) -> None:
        await self._running.stop()
        await self._hands.stop()
