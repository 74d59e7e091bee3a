"""Tests of the connection to a reader process: partial frames, responses larger than its buffer, its end."""

from __future__ import annotations

import asyncio
import socket
from contextlib import suppress
from typing import TYPE_CHECKING

import pytest
from patience import patient
from query.readers.asking import question, until, whole

from kg.query.readers.messages import Progress, frame
from kg.query.readers.pool import Readers
from kg.query.readers.processes import Channel

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.store.layout import Layout

pytestmark = pytest.mark.usefixtures("forked")

PART = bytes(range(256)) * 256
"""As large as the parts of a response."""


def connected(test: Callable[[Channel, socket.socket], Awaitable[None]]) -> None:
    """Run a test with a channel and the other end of its connection."""

    async def run() -> None:
        near, far = socket.socketpair()
        far.setblocking(False)
        _, channel = await asyncio.get_running_loop().create_connection(Channel, sock=near)
        try:
            await test(channel, far)
        finally:
            channel.abort()
            far.close()

    asyncio.run(asyncio.wait_for(run(), patient(20)))


def test_frames_come_in_pieces() -> None:
    """A frame is complete with its last byte; several may arrive at once."""

    async def test(channel: Channel, far: socket.socket) -> None:
        sent = frame(Progress(3))
        for byte in sent[:-1]:
            far.send(bytes([byte]))
            assert not await channel.wait(0.001)
        far.send(sent[-1:] + frame(b"one") + frame(b"two"))
        assert await channel.wait(patient(5))
        assert [channel.take() for _ in range(3)] == [Progress(3), b"one", b"two"]
        assert not await channel.wait(0)

    connected(test)


def test_what_nobody_takes_holds_up_who_sends() -> None:
    """At most a mebibyte of an unread response is buffered; all of it arrives when it is read."""
    count = 64
    data = frame(PART) * count

    async def test(channel: Channel, far: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        system = far.getsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF)
        sent = 0
        for _ in range(100):
            with suppress(BlockingIOError):
                sent += far.send(data[sent:])
            await asyncio.sleep(0.002)
        assert sent < (1 << 20) + system
        sending = loop.create_task(loop.sock_sendall(far, data[sent:]))
        for _ in range(count):
            assert await channel.wait(patient(5))
            assert channel.take() == PART
        await sending
        assert not await channel.wait(0)

    connected(test)


def test_a_frame_may_be_larger_than_the_buffer() -> None:
    """A part of several mebibytes, such as one long text, arrives as a whole, followed by the next."""
    large = PART * 48

    async def test(channel: Channel, far: socket.socket) -> None:
        sending = asyncio.create_task(
            asyncio.get_running_loop().sock_sendall(far, frame(large) + frame(large) + frame(b"end"))
        )
        for part in (large, large, b"end"):
            assert await channel.wait(patient(10))
            assert channel.take() == part
        await sending

    connected(test)


def test_the_end_of_a_connection() -> None:
    """Frames before the end can be read; a cut frame is dropped."""

    async def test(channel: Channel, far: socket.socket) -> None:
        far.send(frame(b"whole") + frame(b"cut")[:-1])
        far.close()
        assert await channel.wait(patient(5))
        assert not channel.ended
        assert channel.take() == b"whole"
        assert await channel.wait(patient(5))
        assert channel.take() is None
        await until(lambda: channel.ended)

    connected(test)


def test_the_reset_of_a_connection_is_told() -> None:
    """Closing without having read everything resets the connection, which `take` raises."""

    async def test(channel: Channel, far: socket.socket) -> None:
        channel.send(b"not read")
        await asyncio.sleep(0.01)
        far.close()
        assert await channel.wait(patient(5))
        await until(lambda: channel.error is not None)
        with pytest.raises(ConnectionError):
            channel.take()

    connected(test)


def test_answers_larger_than_the_buffer(layout: Layout) -> None:
    """A response of several mebibytes is complete, read fast or slowly, and its reader answers the next request."""
    text = "SELECT ?a ?b ?c ?d { ?a ?b ?c . ?d <https://example.org/number> ?n } LIMIT 40000"

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            head, body, end = await whole(readers, text)
            assert (head.kind, end.rows) == ("rows", 40_000)
            assert len(body) > 4 << 20
            async with readers.ask(question(text), seconds=patient(20)) as answer:
                taken = []
                async for part in answer.parts():
                    taken.append(part)
                    await asyncio.sleep(0.002)
            assert b"".join(taken) == body
            _, small, _ = await whole(readers, "ASK {}")
            assert b"true" in small

    asyncio.run(ask())
