"""Reader processes seen from their owner: the connection to each, their fork server, and the pool of them."""

from __future__ import annotations

import asyncio
import itertools
import logging
import os
import socket
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from typing import Any, Final, cast

from kg.errors import QueryError
from kg.query.readers.forkserver import END, FORK, ORDER, PAUSE, RESUME, YIELD
from kg.query.readers.messages import PREFIX, Configuration, Message, Refresh, decode, frame

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

        Raises Exception: the error that closed the connection.
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


PROGRAM: Final = (sys.executable, "-P", "-m", "kg.query.readers.forkserver")
"""Command of the fork server."""

_LOG: Final = logging.getLogger(__name__)
_ONE_THREAD: Final = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Numeric libraries start threads when they are loaded, which makes forking unsafe."""
_PROCESSOR_CLOCK: Final = 2
"""Kind of the processor clock of a process, in the low bits of its clock ID (clock_getcpuclockid(3))."""
_KEPT_BYTES: Final = 4096
_OUT_OF_MEMORY: Final = (
    b"memory allocation of",
    b"bad_alloc",
    b"MemoryError",
    b"Cannot allocate memory",
    b"Resource temporarily unavailable",
)
"""Error messages of Rust, C++, Python and the system; the last one if a thread cannot be started."""


class _ErrorOutput:
    """Standard error of a process, which is logged and explains why the process exited."""

    def __init__(self, file: int) -> None:
        self._file = file
        self.text = b""
        os.set_blocking(file, False)
        asyncio.get_running_loop().add_reader(file, self.listen)

    def listen(self) -> None:
        """Read the available output."""
        if self._file < 0:
            return
        with suppress(BlockingIOError):
            while output := os.read(self._file, _KEPT_BYTES):
                self.text = (self.text + output)[-_KEPT_BYTES:]
                _LOG.info("a reader reported: %s", output.decode("utf-8", "replace").rstrip())
            self.close()

    def close(self) -> None:
        """Close the pipe."""
        if self._file >= 0:
            asyncio.get_running_loop().remove_reader(self._file)
            os.close(self._file)
            self._file = -1


class Process:
    """One reader: a connection to it, and orders for its fork server.

    `nice` is whether its priority was lowered, which is irreversible. `pid` is its process ID, 0 until it reports it.
    `unread` is whether it exited before reading the request.
    """

    def __init__(self, channel: Channel, stderr: _ErrorOutput, order: Callable[[bytes], None]) -> None:
        self._channel = channel
        self._stderr = stderr
        self._order = order
        self.unread = False
        self._began = 0.0
        self.nice = False
        self.pid = 0

    def send(self, data: bytes) -> None:
        """Send a frame; `receive` detects whether the reader has exited."""
        self._channel.send(data)

    async def receive(self) -> Any:
        """Return the next message or part; None if the reader has exited. May be cancelled and called again."""
        while not await self._channel.wait():
            pass
        try:
            return self._channel.take()
        except ConnectionError:
            # The system resets a connection only if the other end is closed with unread data.
            self.unread = True
            return None

    async def wait(self, seconds: float) -> bool:
        """Wait for at most `seconds`; return whether `receive` has a result."""
        return await self._channel.wait(seconds)

    @property
    def ended(self) -> bool:
        """Whether the reader has exited and all its output was received."""
        return self._channel.ended

    @property
    def out_of_memory(self) -> bool:
        """Whether its standard error reports a lack of memory."""
        self._stderr.listen()
        return any(words in self._stderr.text for words in _OUT_OF_MEMORY)

    def start(self, request: bytes) -> None:
        """Send a request; `used` counts from now on."""
        self._began = self._clock()
        self.send(request)

    def used(self) -> float:
        """Return the processor seconds of all threads since `start`.

        Without such a clock in the system, return elapsed seconds.
        """
        return self._clock() - self._began

    def _clock(self) -> float:
        if sys.platform != "linux":
            return time.monotonic()
        try:
            return time.clock_gettime(~self.pid << 3 | _PROCESSOR_CLOCK)
        except OSError:  # the reader has exited
            return self._began

    def give_way(self) -> None:
        """Lower the priority of the reader, irreversibly."""
        self.nice = True
        self._order(YIELD)

    def pause(self) -> None:
        """Pause the reader until `resume`."""
        self._order(PAUSE)

    def resume(self) -> None:
        """Resume the reader after `pause`."""
        self._order(RESUME)

    def kill(self) -> None:
        """Kill the reader; a waiting `receive` returns at once."""
        self._order(END)
        self._channel.abort()

    def close(self) -> None:
        """Kill the reader and release its resources."""
        self.kill()
        self._stderr.listen()
        self._stderr.close()


class Spawner:
    """Fork server of readers, started on demand and restarted after it exits.

    `program` is its command; it imports the module of `configuration.calls` in advance.
    """

    def __init__(self, configuration: Configuration, program: Sequence[str] = PROGRAM) -> None:
        self._first = frame(configuration)
        self._command = [*program, *([configuration.calls] if configuration.calls else [])]
        self._server: subprocess.Popen[bytes] | None = None
        self._orders: socket.socket | None = None
        self._stderr: _ErrorOutput | None = None
        self._numbers = itertools.count()

    async def spawn(self) -> Process:
        """Return a new reader.

        Raises QueryError: KG508 if no process can be started.
        """
        number = next(self._numbers)
        try:
            with ExitStack() as ours, ExitStack() as theirs:
                near, far, stderr, write_end = _channels(ours, theirs)
                self._start()
                with suppress(ConnectionError):  # if the server exits now, the reader is found to have exited
                    self._send(FORK, number, [far.fileno(), write_end])
                _, channel = await asyncio.get_running_loop().create_connection(Channel, sock=near)
                ours.pop_all()
        except OSError as error:
            raise QueryError("KG508", f"no process for queries can be started: {error}") from error
        process = Process(channel, stderr, lambda what: self._order(what, number))
        process.send(self._first)
        return process

    def _start(self) -> None:
        if self._is_serving():
            return
        self._disconnect()
        with ExitStack() as ours, ExitStack() as theirs:
            near, far, stderr, write_end = _channels(ours, theirs)
            self._server = subprocess.Popen(  # noqa: S603 - our own interpreter
                self._command,
                stdin=far.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=write_end,
                env={**os.environ, **_ONE_THREAD},
                start_new_session=True,
            )
            self._orders, self._stderr = near, stderr
            ours.pop_all()

    def _is_serving(self) -> bool:
        """Return whether the server runs. Its socket closes before the system reports its exit."""
        if self._server is None or self._orders is None or self._server.poll() is not None:
            return False
        try:
            return bool(self._orders.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT))
        except BlockingIOError:
            return True
        except OSError:
            return False

    def _send(self, what: bytes, number: int, files: Sequence[int] = ()) -> None:
        if self._orders is not None:
            socket.send_fds(self._orders, [ORDER.pack(what, number)], files)

    def _order(self, what: bytes, number: int) -> None:
        """Send an order for a reader; ignored if the server, and so its readers, have exited."""
        with suppress(OSError):
            self._send(what, number)

    def _disconnect(self) -> None:
        """Close the connections to the server, which makes it exit."""
        if self._orders is not None:
            self._orders.close()
        if self._stderr is not None:
            self._stderr.close()
        self._orders = self._stderr = None

    async def close(self) -> None:
        """Stop the server and all readers."""
        if self._orders is not None:
            self._orders.close()
            self._orders = None
        if self._server is not None:
            await asyncio.to_thread(self._server.wait)
        self._disconnect()


def _channels(ours: ExitStack, theirs: ExitStack) -> tuple[socket.socket, socket.socket, _ErrorOutput, int]:
    """Return both ends of a socket, and of a pipe for standard error; each stack closes those of its owner."""
    near, far = socket.socketpair()
    ours.callback(near.close)
    theirs.callback(far.close)
    read_end, write_end = os.pipe()
    theirs.callback(os.close, write_end)
    stderr = _ErrorOutput(read_end)
    ours.callback(stderr.close)
    return near, far, stderr, write_end


class Fleet:
    """Readers started by `spawner`; `ready` of them are idle, so requests rarely wait for a process to start.

    Up to twice as many idle readers remain, to avoid restarts when load varies. A reader with lowered priority is not
    reused. `spawned` counts the readers started so far, `ended` those that exited, by cause.
    """

    def __init__(self, spawner: Spawner, ready: int) -> None:
        self._spawner = spawner
        self._ready = ready
        self._idle: list[Process] = []
        self._used: set[Process] = set()
        self._outdated: set[Process] = set()
        self._filling: asyncio.Task[None] | None = None
        self._closing = False
        self.spawned = 0
        self.ended: Counter[str] = Counter()

    @property
    def idle(self) -> int:
        """Number of idle readers."""
        return len(self._idle)

    async def take(self, register: Callable[[asyncio.Future[None]], object]) -> Process:
        """Return an idle reader, or start one. An exception set on the future passed to `register` ends the wait.

        Raises QueryError: KG508 if no process can be started.
        """
        process = self._pop_idle() or await self._spawn_unless_cancelled(register)
        self._used.add(process)
        self.fill()
        return process

    def put(self, process: Process) -> None:
        """Return a reader that is ready for the next request."""
        self._used.discard(process)
        if process.ended or process.nice or self._closing or len(self._idle) >= 2 * self._ready:
            self._close(process, "retired")
        else:
            self._idle.append(process)
            if process in self._outdated:
                process.send(frame(Refresh()))
        self._outdated.discard(process)
        self.fill()

    def drop(self, process: Process, cause: str) -> None:
        """Kill a busy reader and count the cause."""
        self._used.discard(process)
        self._outdated.discard(process)
        self._close(process, cause)
        self.fill()

    def refresh(self) -> None:
        """Notify idle readers that the data has changed; busy ones are notified when they are done."""
        self._outdated = set(self._used)
        for process in self._idle:
            process.send(frame(Refresh()))

    def fill(self) -> None:
        """Start missing idle readers in the background."""
        if self._filling is None and not self._closing and len(self._idle) < self._ready:
            self._filling = asyncio.get_running_loop().create_task(self._fill())

    async def close(self) -> None:
        """Kill all readers and their fork server."""
        self._closing = True
        if self._filling is not None:
            self._filling.cancel()
            await asyncio.gather(self._filling, return_exceptions=True)
        for process in [*self._idle, *self._used]:
            process.close()
        self._idle.clear()
        self._used.clear()
        await self._spawner.close()

    def _pop_idle(self) -> Process | None:
        """Remove and return the idle reader used last, whose caches are warm; None if all are busy."""
        while self._idle:
            process = self._idle.pop()
            if not process.ended:
                return process
            self._close(process, "crashed")
        return None

    async def _fill(self) -> None:
        try:
            while (missing := self._ready - len(self._idle)) > 0:
                fresh = await asyncio.gather(*(self._spawn() for _ in range(missing)))
                for process in fresh:
                    # The data may have changed after the reader opened it.
                    process.send(frame(Refresh()))
                self._idle[:0] = fresh
        except QueryError:
            # The next request that needs a reader tries again and reports the error.
            return
        finally:
            self._filling = None

    async def _spawn_unless_cancelled(self, register: Callable[[asyncio.Future[None]], object]) -> Process:
        """Return a new reader; raises the exception set on the registered future if that comes first."""
        cancelled: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        register(cancelled)
        starting = asyncio.ensure_future(self._spawn())
        cancelled.add_done_callback(lambda _: starting.cancel())
        try:
            return await starting
        except asyncio.CancelledError:
            if starting.done() and not starting.cancelled() and starting.exception() is None:
                # The reader was ready at the moment when the request was cancelled.
                self.put(starting.result())
            if cancelled.done():
                cancelled.result()
            raise
        finally:
            # Retrieve the exception; otherwise asyncio reports that it was never retrieved.
            if not cancelled.cancel():
                cancelled.exception()

    async def _spawn(self) -> Process:
        # The fork server may exit before it has read the order; the second attempt starts another.
        process = await self._spawn_once() or await self._spawn_once()
        if process is None:
            raise QueryError("KG508", "no process for queries can be started", hint="The log has its output.")
        self.spawned += 1
        return process

    async def _spawn_once(self) -> Process | None:
        """Return a new reader; None if it exited before it was ready."""
        process = await self._spawner.spawn()
        try:
            ready = await process.receive()
        except BaseException:
            process.close()
            raise
        if ready is None:
            process.close()
            return None
        process.pid = ready.pid
        return process

    def _close(self, process: Process, cause: str) -> None:
        process.close()
        self.ended[cause] += 1
