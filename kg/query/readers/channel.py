"""Connection to a reader process: split the byte stream into frames."""

from __future__ import annotations

import asyncio
from typing import Final, cast

from kg.query.readers.messages import PREFIX, Message, decode

_BUFFER_BYTES: Final = 512 << 10
"""If the buffer contains more bytes, the reader process has to wait."""


class Channel(asyncio.Protocol):
    """Buffer for the frames that a reader process sends. One caller waits at a time.

    `error` is the error that closed the connection, if any.
    """

    def __init__(self) -> None:
        self.error: Exception | None = None
        self._transport: asyncio.Transport | None = None
        self._buffer = bytearray()
        self._closed = False
        self._paused = False
        self._waiting: asyncio.Future[None] | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Store the transport."""
        self._transport = cast("asyncio.Transport", transport)

    def data_received(self, data: bytes) -> None:
        """Append to the buffer."""
        self._buffer += data
        if self._is_complete():
            if len(self._buffer) > _BUFFER_BYTES and not self._paused and self._transport is not None:
                self._paused = True
                self._transport.pause_reading()
            self._wake()

    def eof_received(self) -> None:
        """Record the end of the stream; the transport then closes itself."""
        self._closed = True
        self._wake()

    def connection_lost(self, exc: Exception | None) -> None:
        """Record the end of the connection and its error."""
        self._closed, self.error = True, exc
        self._wake()

    @property
    def ended(self) -> bool:
        """Whether the connection is closed and everything received was taken."""
        return self.error is not None or (self._closed and not self._buffer)

    def send(self, data: bytes) -> None:
        """Send bytes to the reader process."""
        if self._transport is not None:
            self._transport.write(data)

    def abort(self) -> None:
        """Close the connection and discard the buffer."""
        if self._transport is not None:
            self._transport.abort()

    async def wait(self, seconds: float | None = None) -> bool:
        """Wait until `take` has a result, for at most `seconds`; return whether it has."""
        if self._is_complete() or self._closed:
            return True
        loop = asyncio.get_running_loop()
        self._waiting = loop.create_future()
        timer = None if seconds is None else loop.call_later(seconds, self._wake)
        try:
            await self._waiting
        finally:
            self._waiting = None
            if timer is not None:
                timer.cancel()
        return self._is_complete() or self._closed

    def take(self) -> Message | bytes | None:
        """Return the next message or part; None at the end of the stream.

        Raises:
            Exception: the error that closed the connection.
        """
        if self.error is not None:
            raise self.error
        if not self._is_complete():
            self._buffer.clear()
            return None
        length, kind = PREFIX.unpack_from(self._buffer)
        end = PREFIX.size + length
        body = bytes(memoryview(self._buffer)[PREFIX.size : end])
        del self._buffer[:end]
        if self._paused and not self._closed and len(self._buffer) <= _BUFFER_BYTES and self._transport is not None:
            self._paused = False
            self._transport.resume_reading()
        return decode(kind, body)

    def _is_complete(self) -> bool:
        """Return whether the buffer begins with a whole frame."""
        size = len(self._buffer)
        return size >= PREFIX.size and size >= PREFIX.size + PREFIX.unpack_from(self._buffer)[0]

    def _wake(self) -> None:
        if self._waiting is not None and not self._waiting.done():
            self._waiting.set_result(None)
