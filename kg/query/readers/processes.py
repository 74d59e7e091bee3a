"""Reader processes as the pool sees them, and the process that they are forked from."""

from __future__ import annotations

import asyncio
import itertools
import logging
import os
import socket
import subprocess
import sys
import time
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any, Final

from kg.errors import QueryError
from kg.query.readers.channel import Channel
from kg.query.readers.forkserver import END, FORK, ORDER, PAUSE, RESUME, YIELD
from kg.query.readers.messages import Configuration, frame

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


PROGRAM: Final = (sys.executable, "-P", "-m", "kg.query.readers.forkserver")
"""What readers are forked from."""

_LOG: Final = logging.getLogger(__name__)
_ONE_THREAD: Final = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Libraries of numbers start threads when they are loaded, which do not get along with forking."""
_PROCESSOR_CLOCK: Final = 2
"""The clock of a process that counts its processor time has this kind, below its number (clock_getcpuclockid(3))."""
_KEPT_BYTES: Final = 4096
_OUT_OF_MEMORY: Final = (
    b"memory allocation of",
    b"bad_alloc",
    b"MemoryError",
    b"Cannot allocate memory",
    b"Resource temporarily unavailable",
)
"""Words of Rust, C++, Python and the system, the last where there is no room for another thread."""


class _LastWords:
    """What a process says on its standard error: for the log, and to tell why it ended."""

    def __init__(self, file: int) -> None:
        self._file = file
        self.text = b""
        os.set_blocking(file, False)
        asyncio.get_running_loop().add_reader(file, self.listen)

    def listen(self) -> None:
        """Take what was said up to now."""
        if self._file < 0:
            return
        with suppress(BlockingIOError):
            while said := os.read(self._file, _KEPT_BYTES):
                self.text = (self.text + said)[-_KEPT_BYTES:]
                _LOG.info("a reader reported: %s", said.decode("utf-8", "replace").rstrip())
            self.close()

    def close(self) -> None:
        """Listen no more."""
        if self._file >= 0:
            asyncio.get_running_loop().remove_reader(self._file)
            os.close(self._file)
            self._file = -1


class Process:
    """One reader: a socket to speak on, and a way to end it.

    `nice` tells that its priority was lowered, which cannot be taken back; `pid` is what the system calls it, 0 as long
    as it has not said so. `unread` tells of one that has ended that it had not read what it was sent.
    """

    def __init__(
        self,
        channel: Channel,
        words: _LastWords,
        order: Callable[[bytes], None],
    ) -> None:
        self._channel = channel
        self._words = words
        self._order = order
        self.unread = False
        self._began = 0.0
        self.nice = False
        self.pid = 0

    def send(self, data: bytes) -> None:
        """Send a frame; a reader that has ended is noticed when its answer is waited for."""
        self._channel.send(data)

    async def receive(self) -> Any:
        """Return the next message or part, None when the reader has ended; may be cancelled and called again."""
        while not await self._channel.wait():
            pass
        try:
            return self._channel.take()
        except ConnectionError:
            # The system resets a connection whose other end is closed before all was read there, and only then.
            self.unread = True
            return None

    async def wait(self, seconds: float) -> bool:
        """Wait for at most `seconds`; return whether `receive` has a result."""
        return await self._channel.wait(seconds)

    @property
    def ended(self) -> bool:
        """Whether the reader is known to have ended, with all it said taken."""
        return self._channel.ended

    @property
    def out_of_memory(self) -> bool:
        """Whether its last words were that it got no more memory."""
        self._words.listen()
        return any(words in self._words.text for words in _OUT_OF_MEMORY)

    def start(self, request: bytes) -> None:
        """Send a request; `used` counts from now on."""
        self._began = self._clock()
        self.send(request)

    def used(self) -> float:
        """Return the processor seconds used since `start`, by all threads; seconds where the system does not tell."""
        return self._clock() - self._began

    def _clock(self) -> float:
        if sys.platform != "linux":
            return time.monotonic()
        try:
            return time.clock_gettime(~self.pid << 3 | _PROCESSOR_CLOCK)
        except OSError:  # it has ended
            return self._began

    def give_way(self) -> None:
        """Lower its priority for good."""
        self.nice = True
        self._order(YIELD)

    def pause(self) -> None:
        """Stop it until `resume`."""
        self._order(PAUSE)

    def resume(self) -> None:
        """Let it run again after `pause`."""
        self._order(RESUME)

    def kill(self) -> None:
        """End the reader, whatever it does; who waits for it is told at once."""
        self._order(END)
        self._channel.abort()

    def close(self) -> None:
        """End the reader and let go of all that belongs to it."""
        self.kill()
        self._words.listen()
        self._words.close()


class Spawner:
    """The process that readers are forked from; it is started when there is none, and again when it has ended.

    `program` is what to run, `modules` what it is to import beforehand.
    """

    def __init__(self, configuration: Configuration, program: Sequence[str] = PROGRAM) -> None:
        self._first = frame(configuration)
        self._command = [*program, *([configuration.calls] if configuration.calls else [])]
        self._server: subprocess.Popen[bytes] | None = None
        self._orders: socket.socket | None = None
        self._words: _LastWords | None = None
        self._numbers = itertools.count()

    async def spawn(self) -> Process:
        """Return a new reader.

        Raises:
            QueryError: KG508 when no process can be started.
        """
        number = next(self._numbers)
        try:
            with ExitStack() as ours, ExitStack() as theirs:
                near, far, words, said = _channels(ours, theirs)
                self._start()
                with suppress(ConnectionError):  # where the server has just ended the reader is seen to have ended
                    self._send(FORK, number, [far.fileno(), said])
                _, channel = await asyncio.get_running_loop().create_connection(Channel, sock=near)
                ours.pop_all()
        except OSError as error:
            raise QueryError("KG508", f"no process for queries can be started: {error}") from error
        process = Process(channel, words, lambda what: self._tell(what, number))
        process.send(self._first)
        return process

    def _start(self) -> None:
        if self._serves():
            return
        self._let_go()
        with ExitStack() as ours, ExitStack() as theirs:
            near, far, words, said = _channels(ours, theirs)
            self._server = subprocess.Popen(  # noqa: S603 - our own interpreter
                self._command,
                stdin=far.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=said,
                env={**os.environ, **_ONE_THREAD},
                start_new_session=True,
            )
            self._orders, self._words = near, words
            ours.pop_all()

    def _serves(self) -> bool:
        """Tell whether there is a server: when one ends its socket is closed before the system says that it has."""
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

    def _tell(self, what: bytes, number: int) -> None:
        """Order something of a reader; when the server has ended its readers have too."""
        with suppress(OSError):
            self._send(what, number)

    def _let_go(self) -> None:
        """Close what leads to the server, which ends by that."""
        if self._orders is not None:
            self._orders.close()
        if self._words is not None:
            self._words.close()
        self._orders = self._words = None

    async def close(self) -> None:
        """End the server, and with it every reader."""
        if self._orders is not None:
            self._orders.close()
            self._orders = None
        if self._server is not None:
            await asyncio.to_thread(self._server.wait)
        self._let_go()


def _channels(ours: ExitStack, theirs: ExitStack) -> tuple[socket.socket, socket.socket, _LastWords, int]:
    """Return two ends of a connection, and two of what a process says; each is closed by the stack of its owner."""
    near, far = socket.socketpair()
    ours.callback(near.close)
    theirs.callback(far.close)
    errors, said = os.pipe()
    theirs.callback(os.close, said)
    words = _LastWords(errors)
    ours.callback(words.close)
    return near, far, words, said
