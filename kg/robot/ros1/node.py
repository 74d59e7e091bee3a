"""Our node in the graph of ROS 1: the Slave API, the TCPROS port, and its registrations at the master.

The API is that of wiki.ros.org/ROS/Slave_API.
"""

from __future__ import annotations

import asyncio
import os
from collections import Counter
from typing import TYPE_CHECKING, Any, Final
from weakref import WeakValueDictionary

from kg.errors import RobotError
from kg.robot.connection import GraphProblem, Value
from kg.robot.ros1.header import pack, read_header
from kg.robot.ros1.names import listening, netloc, own_host, peer, shown
from kg.robot.ros1.services import Service
from kg.robot.ros1.topics import Offer, Ros1Subscription
from kg.robot.ros1.xmlrpc import XmlRpcServer, ask, listen
from kg.robot.tasks import Tasks

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine

    from kg.robot.clock import Clock
    from kg.robot.messages import Types

_MOST_CONNECTIONS: Final = 1024
_MOST_PROBLEMS: Final = 256
_MOST_PUBLISHERS: Final = 1000
_HEARTBEAT: Final = 1.0
_MISSED: Final = 3
_NOT_SUPPORTED: Final = [-1, "it does not fit the Slave API", 0]


class Node:
    """A node registered at a master, through which all other modules of this folder communicate."""

    def __init__(self, master: str, name: str, types: Types, clock: Clock) -> None:
        self.master = master
        self.name = name
        self.types = types
        self.clock = clock
        self.lost: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        self.offers: dict[str, Offer] = {}
        self.subscriptions: dict[str, list[Ros1Subscription]] = {}
        self.services: dict[str, Service] = {}
        self.problems: dict[GraphProblem, None] = {}
        self.uri = ""
        self._service_uri = ""
        self._http = XmlRpcServer(self._handle)
        self._tcp: asyncio.Server | None = None
        self._tasks = Tasks()
        self._turns: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()
        self._updates: Counter[str] = Counter()
        self._port = 0
        self._host = ""
        self._calls: dict[str, tuple[int, Callable[..., list[Any]]]] = {
            "getPid": (0, lambda: [1, "", os.getpid()]),
            "getMasterUri": (0, lambda: [1, "", self.master]),
            "shutdown": (1, self._on_shutdown),
            "paramUpdate": (2, lambda *_: [1, "", 0]),
            "getPublications": (0, lambda: [1, "", [[one.topic, one.kind] for one in self.offers.values()]]),
            "getSubscriptions": (0, lambda: [1, "", [[one, each[0].kind] for one, each in self.subscriptions.items()]]),
            "getBusStats": (0, lambda: [1, "", [[], [], []]]),
            "getBusInfo": (0, self._on_bus_info),
            "publisherUpdate": (2, self._on_publishers),
            "requestTopic": (2, self._on_request),
        }
        """The methods of the Slave API: the number of arguments after the caller's name, and the response."""

    async def start(self) -> None:
        """Listen for peers; RobotError KG814 if our address is not one of this machine."""
        self._host = own_host(*peer(self.master))
        place = listening(self._host)
        try:
            await asyncio.get_running_loop().getaddrinfo(self._host, 0)
            port = await self._http.start(place)
            self._tcp = await listen(self._serve, place)
        except (OSError, UnicodeError) as error:
            raise RobotError("KG814", f"this node cannot be reached as `{self._host}`: {error}") from None
        self._port = self._tcp.sockets[0].getsockname()[1]
        self.uri = f"http://{netloc(self._host, port)}/"
        self._service_uri = f"rosrpc://{netloc(self._host, self._port)}"
        self.spawn(self._keep_registered(), "staying registered")

    def spawn(self, work: Coroutine[Any, Any, None], what: str) -> asyncio.Task[None]:
        """Run a task for the lifetime of the node; an error that ends it is reported as one of `what`."""
        return self._tasks.spawn(work, what)

    def note(self, code: str, subject: str, message: str) -> None:
        """Record an error of a peer, for the graph; the oldest ones are dropped."""
        self.problems[GraphProblem(code, shown(subject), message)] = None
        while len(self.problems) > _MOST_PROBLEMS:
            del self.problems[next(iter(self.problems))]

    def present(self) -> None:
        """Raise RobotError KG803 if the node is no longer in the graph."""
        if self.lost.done():
            raise RobotError("KG803", f"the robot is lost: {self.lost.result()}")

    def lose(self, why: str) -> None:
        """Close everything, because the master is gone or requests it."""
        if not self.lost.done():
            self.lost.set_result(why)
        for one in [one for ones in self.subscriptions.values() for one in ones]:
            one.end()

    async def ask(self, method: str, *arguments: Any) -> Any:
        """Call the master in our name; errors as those of `http.ask`."""
        return await ask(self.master, method, self.name, *arguments)

    def _turn(self, name: str) -> asyncio.Lock:
        """Return a lock that keeps requests about a name in order, although each has a connection of its own."""
        return self._turns.setdefault(name, asyncio.Lock())

    async def _in_turn(self, method: str, name: str, *arguments: Any) -> Any:
        """Send a request about a topic or service after the previous one about it has been answered."""
        async with self._turn(name):
            return await self.ask(method, name, *arguments)

    async def offer(self, topic: str, kind: str) -> Offer:
        """Publish a topic; RobotError KG806 if we already publish it with another type."""
        offer = self.offers.get(topic)
        if offer is None:
            self.types.md5(kind)
            offer = self.offers[topic] = Offer(self, topic, kind)
            offer.registered = asyncio.ensure_future(self._in_turn("registerPublisher", topic, kind, self.uri))
        if offer.kind != kind:
            raise RobotError("KG806", f"`{topic}` is offered as {offer.kind} already, not as {kind}")
        try:
            await asyncio.shield(offer.registered)  # other waiters might not be cancelled
        except RobotError:
            if self.offers.get(topic) is offer:
                del self.offers[topic]
            raise
        offer.users += 1
        return offer

    async def withdraw(self, offer: Offer) -> None:
        """Release a topic; the last release closes it."""
        offer.users -= 1
        if offer.users == 0 and self.offers.pop(offer.topic, None) is not None:
            offer.close()
            await self._notify_master("unregisterPublisher", offer.topic, self.uri)

    async def join(self, subscription: Ros1Subscription) -> None:
        """Subscribe to a topic; not at all if the master refuses or does not answer."""
        self.subscriptions.setdefault(subscription.topic, []).append(subscription)
        try:
            await self._enrol(subscription.topic, subscription.kind)
        except (RobotError, asyncio.CancelledError):
            await subscription.aclose()
            raise

    async def _enrol(self, topic: str, kind: str) -> None:
        """Register as a subscriber, and connect to the publishers that the master lists."""
        async with self._turn(topic):
            version = self._updates[topic]
            publishers = await self.ask("registerSubscriber", topic, kind, self.uri)
        if self._updates[topic] == version:  # a later notification is newer than the answer
            self._update(topic, publishers)

    async def leave(self, subscription: Ros1Subscription) -> None:
        """Unsubscribe after the last subscription of the topic."""
        others = self.subscriptions.get(subscription.topic, [])
        if subscription in others:
            others.remove(subscription)
        if not others and self.subscriptions.pop(subscription.topic, None) is not None:
            await self._notify_master("unregisterSubscriber", subscription.topic, self.uri)

    async def serve(self, name: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> None:
        """Serve a service; RobotError KG804 if its type is unknown."""
        self.types.md5(kind)
        service = self.services[name] = Service(self, name, kind, answer)
        try:
            await self._in_turn("registerService", name, self._service_uri, self.uri)
        except (RobotError, asyncio.CancelledError):
            await self._stop_serving(service)
            raise

    async def _stop_serving(self, service: Service) -> None:
        if self.services.get(service.name) is service:
            del self.services[service.name]
            await self._notify_master("unregisterService", service.name, self._service_uri)
        service.close()

    async def aclose(self) -> None:
        """Leave the graph."""
        for offer in list(self.offers.values()):
            offer.users = 1
            await self.withdraw(offer)
        for subscription in [one for ones in self.subscriptions.values() for one in ones]:
            await subscription.aclose()
        for service in list(self.services.values()):
            await self._stop_serving(service)
        if not self.lost.done():
            # What was withdrawn just before is no longer listed, but the master may not have received it yet.
            for turn in list(self._turns.values()):
                async with turn:
                    pass
        self.lose("it was closed")
        self._tasks.cancel()
        await self._http.aclose()
        if self._tcp is not None:
            self._tcp.close()

    async def _notify_master(self, method: str, name: str, *arguments: Any) -> None:
        """Send a notification about a topic or service to the master, if it still exists."""
        if not self.lost.done():
            try:
                await self._in_turn(method, name, *arguments)
            except RobotError as error:
                self.note(error.code, self.master, error.message)

    async def _keep_registered(self) -> None:
        """Check that the master is alive and lists this node; register again with a restarted one."""
        missed = 0
        while not self.lost.done():
            await asyncio.sleep(_HEARTBEAT)
            try:
                await self.ask("lookupNode", self.name)
                missed = 0
            except RobotError as error:
                missed += error.code != "KG813"
                if error.code == "KG813":
                    await self._register_again()
                elif missed == _MISSED:
                    self.lose(f"the master does not answer any more: {error.message}")

    async def _register_again(self) -> None:
        """Register everything with a restarted master, allowing for concurrent changes."""
        for offer in list(self.offers.values()):
            if self.offers.get(offer.topic) is offer:
                await self._notify_master("registerPublisher", offer.topic, offer.kind, self.uri)
        for service in list(self.services):
            if service in self.services:
                await self._notify_master("registerService", service, self._service_uri, self.uri)
        for topic in list(self.subscriptions):
            if subscriptions := self.subscriptions.get(topic):
                try:
                    await self._enrol(topic, subscriptions[0].kind)
                except RobotError as error:
                    self.note(error.code, self.master, error.message)

    def _update(self, topic: str, publishers: object) -> bool:
        """Update the publishers of a topic; return whether the list is valid."""
        if not isinstance(publishers, list) or not all(isinstance(one, str) for one in publishers):
            self.note("KG810", self.master, f"the list of publishers of `{shown(topic)}` is {shown(publishers)}")
            return False
        if len(publishers) > _MOST_PUBLISHERS:
            words = f"`{shown(topic)}` has {len(publishers)} publishers; the first {_MOST_PUBLISHERS} are read"
            self.note("KG810", self.master, words)
        # The master may list our own publication for a moment after it was withdrawn.
        wanted = [one for one in publishers[:_MOST_PUBLISHERS] if one != self.uri or topic in self.offers]
        for subscription in self.subscriptions.get(topic, []):
            subscription.update(wanted)
        return True

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        host = str((writer.get_extra_info("peername") or "?")[0])
        task = asyncio.current_task()
        if task is None or len(self._tasks) > _MOST_CONNECTIONS:
            writer.close()
            return
        self._tasks.hold(task)
        try:
            header = await read_header(reader)
            wanted = header.get("service", header.get("topic", ""))
            served = self.services.get(wanted) if "service" in header else self.offers.get(wanted)
            if served is None:
                writer.write(pack({"error": f"`{shown(wanted)}` is not here"}))
            else:
                await served.serve(header, reader, writer)
        except RobotError as error:
            self.note(error.code, host, error.message)
        except (OSError, asyncio.CancelledError):
            return  # the peer disconnected, or the node has ended; asyncio before 3.12 would log the cancellation
        finally:
            writer.close()

    async def _handle(self, method: str, arguments: list[Any]) -> Any:
        """Respond to the Slave API; KeyError for an unknown method."""
        count, answer = self._calls[method]
        return answer(*arguments[1:]) if len(arguments) == 1 + count else _NOT_SUPPORTED

    def _on_shutdown(self, why: object) -> list[Any]:
        self.lose(f"the master ended this node: {shown(why)}")
        return [1, "", 0]

    def _on_bus_info(self) -> list[Any]:
        outward = [(caller, "o", offer.topic) for offer in self.offers.values() for caller in offer.links.values()]
        inward = [
            (caller, "i", topic)
            for topic, ones in self.subscriptions.items()
            for one in ones
            for caller in one.connected.values()
        ]
        rows = [[n, caller, way, "TCPROS", topic, True] for n, (caller, way, topic) in enumerate(outward + inward)]
        return [1, "", rows]

    def _on_publishers(self, topic: object, publishers: object) -> list[Any]:
        if not isinstance(topic, str) or not self._update(topic, publishers):
            return _NOT_SUPPORTED
        if topic in self.subscriptions:
            self._updates[topic] += 1
        return [1, "", 0]

    def _on_request(self, topic: object, protocols: object) -> list[Any]:
        if not isinstance(topic, str) or topic not in self.offers:
            return [0, f"`{shown(topic)}` is not published here", 0]
        if not isinstance(protocols, list) or ["TCPROS"] not in protocols:
            return [0, "only TCPROS is spoken here", 0]
        return [1, "", ["TCPROS", self._host, self._port]]
