"""Updates from our master to subscribers, and registrations of our node."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.ros1 import Master
from kg.robot.ros1 import node as node_module
from kg.robot.ros1.xmlrpc import XmlRpcServer, ask, call

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.ros1 import Ros1Connection


@asynccontextmanager
async def system() -> AsyncIterator[tuple[Master, Ros1Connection]]:
    """Yield a master and a node of ours."""
    async with Master() as master:
        connection: Any = await connect(master.address, name="/kg")
        try:
            yield master, connection
        finally:
            await connection.aclose()


def test_slow_subscribers_are_told_in_order() -> None:
    """A slow subscriber is notified of publishers one after the other, and of the current ones last."""
    told: list[list[str]] = []
    first, go, again = asyncio.Event(), asyncio.Event(), asyncio.Event()

    async def slow(_: str, arguments: list[Any]) -> Any:
        told.append(arguments[2])
        (again if first.is_set() else first).set()
        await go.wait()
        return [1, "", 0]

    async def scene() -> None:
        async with Master() as master:
            server = XmlRpcServer(slow)
            uri = f"http://127.0.0.1:{await server.start('127.0.0.1')}/"
            await ask(master.uri, "registerSubscriber", "/slow", "/topic", "std_msgs/String", uri)
            for name in ("a", "b", "c"):
                await ask(master.uri, "registerPublisher", f"/{name}", "/topic", "std_msgs/String", f"http://{name}:1/")
                await asyncio.wait_for(first.wait(), patient(5))
            go.set()
            await asyncio.wait_for(again.wait(), patient(5))
            await server.aclose()

    asyncio.run(scene())
    assert told == [["http://a:1/"], ["http://a:1/", "http://b:1/", "http://c:1/"]]


def test_a_loop_that_ends_says_nothing_of_who_was_being_answered() -> None:
    """Ctrl-C may end the loop while a peer has an open connection, without a logged traceback."""
    logged: list[dict[str, Any]] = []

    async def scene() -> None:
        asyncio.get_running_loop().set_exception_handler(lambda _, told: logged.append(told))
        first = asyncio.Event()

        async def answer(_: str, __: list[Any]) -> Any:
            first.set()
            await asyncio.Event().wait()

        server = XmlRpcServer(answer)
        port = await server.start("127.0.0.1")
        calling = asyncio.ensure_future(call(f"http://127.0.0.1:{port}/", "getPid", "/kg"))
        await asyncio.wait_for(first.wait(), patient(5))
        calling.add_done_callback(lambda one: one.cancelled() or one.exception())

    asyncio.run(scene())
    assert logged == []


def test_more_publishers_than_there_can_be(monkeypatch: pytest.MonkeyPatch) -> None:
    """An excessive list of publishers is truncated, and that is reported."""
    noted: list[tuple[str, str, str]] = []

    async def scene() -> None:
        async with system() as (_, kg):
            monkeypatch.setattr(kg.node, "note", lambda *told: noted.append(told))
            subscription = await kg.subscribe("/topic", "std_msgs/String")
            await call(kg.node.uri, "publisherUpdate", "/master", "/topic", [f"http://.{n}/" for n in range(10_000)])
            assert len(subscription.links) == 1000
            assert any(code == "KG810" and "10000 publishers" in words for code, _, words in noted)

    asyncio.run(scene())


def test_what_is_not_registered_is_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rejected registration, or one cancelled before the response, is not repeated later."""
    refusing = True
    asked = asyncio.Event()
    handle = Master._handle

    async def refuse(self: Master, method: str, arguments: list[Any]) -> Any:
        if method not in {"registerSubscriber", "registerService"}:
            return await handle(self, method, arguments)
        if refusing:
            return [-1, "no", 0]
        await handle(self, method, arguments)
        asked.set()
        return await asyncio.Event().wait()

    monkeypatch.setattr(Master, "_handle", refuse)

    async def serve(_: Any) -> Any:
        return {}

    async def scene() -> None:
        nonlocal refusing
        async with system() as (master, kg):
            for work in (kg.subscribe("/topic", "std_msgs/String"), kg.serve("/service", "std_srvs/Empty", serve)):
                with pytest.raises(RobotError) as refused:
                    await work
                assert refused.value.code == "KG813"
            refusing = False
            for work in (kg.subscribe("/other", "std_msgs/String"), kg.serve("/given_up", "std_srvs/Empty", serve)):
                asked.clear()
                given_up = asyncio.ensure_future(work)
                await asyncio.wait_for(asked.wait(), patient(5))
                given_up.cancel()
                await asyncio.gather(given_up, return_exceptions=True)
            assert not kg.node.subscriptions
            assert not kg.node.services
            _, subscribers, services = await ask(master.uri, "getSystemState", "/x")
            assert not subscribers
            assert not services

    asyncio.run(scene())


def test_what_the_master_tells_before_it_answers_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A late response to a registration does not override a newer list of publishers."""
    handle = Master._handle
    registered, go = asyncio.Event(), asyncio.Event()

    async def late(self: Master, method: str, arguments: list[Any]) -> Any:
        answer = await handle(self, method, arguments)
        if method == "registerSubscriber":
            registered.set()
            await go.wait()
        return answer

    monkeypatch.setattr(Master, "_handle", late)

    async def scene() -> None:
        async with system() as (master, kg):
            subscribing = asyncio.ensure_future(kg.subscribe("/topic", "std_msgs/String"))
            await asyncio.wait_for(registered.wait(), patient(5))
            two: Any = await connect(master.address, name="/two")
            publication = await two.advertise("/topic", "std_msgs/String", latch=True)
            await publication.publish({"data": "hello"})
            await call(kg.node.uri, "publisherUpdate", "/master", "/topic", [two.node.uri])
            go.set()
            messages = aiter(await asyncio.wait_for(subscribing, patient(5)))
            assert (await asyncio.wait_for(anext(messages), patient(5))).value == {"data": "hello"}
            await two.aclose()

    asyncio.run(scene())


def test_the_master_hears_of_a_topic_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """A topic advertised again at once is registered only after the master has removed it."""
    handle = Master._handle
    leaving, go = asyncio.Event(), asyncio.Event()
    heard: list[str] = []

    async def slow(self: Master, method: str, arguments: list[Any]) -> Any:
        if method == "unregisterPublisher":
            leaving.set()
            await go.wait()
        if method.endswith("Publisher") and arguments[1] == "/topic":
            heard.append(method)
        return await handle(self, method, arguments)

    monkeypatch.setattr(Master, "_handle", slow)

    async def scene() -> None:
        async with system() as (master, kg):
            publication = await kg.advertise("/topic", "std_msgs/String")
            closing = asyncio.ensure_future(publication.aclose())
            await asyncio.wait_for(leaving.wait(), patient(5))
            again = asyncio.ensure_future(kg.advertise("/topic", "std_msgs/String"))
            await ask(master.uri, "getSystemState", "/x")  # an answer arrives as soon as that of the registration could
            go.set()
            await asyncio.wait_for(asyncio.gather(closing, again), patient(5))
            assert ["/topic", ["/kg"]] in (await ask(master.uri, "getSystemState", "/x"))[0]
            assert heard == ["registerPublisher", "unregisterPublisher", "registerPublisher"]

    asyncio.run(scene())


def test_things_come_and_go_while_a_master_is_told_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ends opened and closed while our node registers at a restarted master leave nothing registered."""
    handle = Master._handle
    telling, go, told_again = asyncio.Event(), asyncio.Event(), asyncio.Event()
    forgotten = kg_is_there = False
    reported: list[dict[str, Any]] = []

    async def slow(self: Master, method: str, arguments: list[Any]) -> Any:
        nonlocal forgotten
        if method == "lookupNode" and forgotten:
            forgotten = False
            return [-1, "no", ""]
        if method == "lookupNode" and telling.is_set():
            told_again.set()
        if method == "registerPublisher" and kg_is_there:
            telling.set()
            await go.wait()
        return await handle(self, method, arguments)

    monkeypatch.setattr(Master, "_handle", slow)
    monkeypatch.setattr(node_module, "_HEARTBEAT", 0.01)

    async def scene() -> None:
        nonlocal forgotten, kg_is_there
        asyncio.get_running_loop().set_exception_handler(lambda _, told: reported.append(told))
        async with system() as (master, kg):
            offered = await kg.advertise("/offered", "std_msgs/String")
            read = await kg.subscribe("/read", "std_msgs/String")
            forgotten = kg_is_there = True
            await asyncio.wait_for(telling.wait(), patient(5))
            await offered.aclose()
            await read.aclose()
            offering = [asyncio.ensure_future(kg.advertise(name, "std_msgs/String")) for name in ("/one", "/two")]
            await asyncio.sleep(0)
            go.set()
            await asyncio.gather(*offering)
            await asyncio.wait_for(told_again.wait(), patient(5))
            publishers, subscribers, _ = await ask(master.uri, "getSystemState", "/x")
            assert sorted(publishers) == [["/one", ["/kg"]], ["/rosout", ["/kg"]], ["/two", ["/kg"]]]
            assert not subscribers

    asyncio.run(scene())
    assert not reported


def test_a_node_that_leaves_waits_for_what_it_withdrew() -> None:
    """A node closes only when the master has answered what was withdrawn before; else the topic could stay."""
    reached, go = asyncio.Event(), asyncio.Event()

    async def scene() -> None:
        async with Master() as master:

            async def slow(method: str, arguments: list[Any]) -> Any:
                if method == "unregisterPublisher" and arguments[1] == "/topic":
                    reached.set()
                    await go.wait()
                return [1, "", await ask(master.uri, method, *arguments)]

            server = XmlRpcServer(slow)
            port = await server.start("127.0.0.1")
            connection = await connect(f"ros1://127.0.0.1:{port}", name="/kg")
            publication = await connection.advertise("/topic", "std_msgs/String")
            withdrawing = asyncio.ensure_future(publication.aclose())
            await asyncio.wait_for(reached.wait(), patient(5))
            closing = asyncio.ensure_future(connection.aclose())
            assert not (await asyncio.wait((closing,), timeout=0.3))[0]
            go.set()
            await asyncio.wait_for(closing, patient(5))
            await withdrawing
            await server.aclose()

    asyncio.run(scene())
