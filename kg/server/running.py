"""Runs the server: checks its options, reports to systemd when it is ready, and stops it gracefully.

The first SIGTERM or Ctrl-C: nothing new is taken, and what runs has its grace; then its readers are killed, so that it
is answered with an error. The second: now. A terminal that is closed (SIGHUP) counts as the first, unless the process
was started to outlive it (nohup). Either way the process ends as one that did what it was told: exit code 0.

Ctrl-Z (SIGTSTP) suspends it, after what must not go on meanwhile was stopped: a robot.
"""

from __future__ import annotations

import asyncio
import gc
import os
import signal
import socket
import threading
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Final

import uvicorn

from kg.errors import UsageError
from kg.server import logs
from kg.server.app import create_app
from kg.server.safety.connections import guarded
from kg.server.safety.hosts import is_loopback
from kg.server.safety.tokens import LEAST, Tokens

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType

    from starlette.applications import Starlette

    from kg.server.options import Options
    from kg.server.state import State
    from kg.settings import Settings


_LAST_WORDS: Final = 2.0  # seconds to report cancelled work to clients


def notify(message: str) -> None:
    """Send a state to systemd (`sd_notify(3)`), if it is listening."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if address.startswith(("/", "@")):
        with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as endpoint:
            endpoint.connect("\0" + address[1:] if address.startswith("@") else address)
            endpoint.sendall(message.encode())


class Server(uvicorn.Server):
    """Uvicorn's server of an application of `create_app`; `ready` is called when it listens.

    The robot is stopped before the process ends or is suspended. Work is cancelled after `grace` seconds.
    """

    def __init__(self, config: uvicorn.Config, app: Starlette, *, grace: float, ready: Callable[[], None]) -> None:
        config.timeout_graceful_shutdown = int(grace + _LAST_WORDS + 1)
        super().__init__(config)
        self._app = app
        self._grace = grace
        self._ready = ready
        self._suspending: asyncio.Task[None] | None = None

    @property
    def _state(self) -> State | None:
        """The shared state, None before the application has started."""
        shared: State | None = getattr(self._app.state, "server", None)
        return shared

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to listen, and call `ready`."""
        await super().startup(sockets)
        self._expect_suspension()
        notify("READY=1")
        self._ready()

    def _expect_suspension(self) -> None:
        mine = threading.current_thread() is threading.main_thread()
        if mine and signal.getsignal(signal.SIGTSTP) is not signal.SIG_IGN:
            asyncio.get_running_loop().add_signal_handler(signal.SIGTSTP, self._be_suspended)

    def _be_suspended(self) -> None:
        if self._suspending is None or self._suspending.done():
            self._suspending = asyncio.ensure_future(self._suspended())

    async def _suspended(self) -> None:
        """Stop the robot, then suspend as Ctrl-Z does by default; return when the process resumes."""
        state = self._state
        try:
            if state is not None and state.robot is not None:
                await state.robot.suspend()
        finally:
            asyncio.get_running_loop().remove_signal_handler(signal.SIGTSTP)
            signal.pthread_kill(threading.get_ident(), signal.SIGTSTP)
            self._expect_suspension()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Stop the robot before anything else, and cancel running work after its grace period."""
        notify("STOPPING=1")
        state = self._state
        leaving = asyncio.ensure_future(state.robot.leave()) if state is not None and state.robot is not None else None
        waiting = asyncio.get_running_loop().call_later(self._grace, self._end)
        hurrying = asyncio.create_task(self._hurry())
        try:
            await super().shutdown(sockets)
        finally:
            waiting.cancel()
            hurrying.cancel()
            self._end()
            if leaving is not None:
                await leaving

    def _end(self) -> None:
        if (state := self._state) is not None:
            for identity in tuple(state.readers.jobs):
                state.readers.cancel(identity)

    async def _hurry(self) -> None:
        """Cancel everything at once on the second signal."""
        while not self.force_exit:  # noqa: ASYNC110 - a handler of signals may set no event of a loop
            await asyncio.sleep(0.1)
        self._end()
        for connection in tuple(self.server_state.connections):
            connection.transport.abort()

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Handle uvicorn's signals, and SIGHUP, while the server runs."""
        mine = threading.current_thread() is threading.main_thread()
        if not mine or signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
            with super().capture_signals():
                yield
            return
        earlier = signal.signal(signal.SIGHUP, self._hang_up)
        try:
            with super().capture_signals():
                yield
        finally:
            signal.signal(signal.SIGHUP, earlier)

    def _hang_up(self, sig: int, frame: FrameType | None) -> None:  # noqa: ARG002 - the signature of a handler
        """Stop gracefully; kernel and shell both send SIGHUP for a closed terminal, so a second one does not hurry."""
        self.should_exit = True

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:  # noqa: ARG002 - the signature of a handler
        """Stop gracefully on the first signal, at once on the second."""
        self.force_exit = self.should_exit
        self.should_exit = True


def serve(settings: Settings, options: Options, announce: Callable[[str], None] = lambda _address: None) -> None:
    """Serve the store of the settings until a signal; `announce` is called with the address.

    Raises:
        StoreError: KG301 no store.
        UsageError: KG540 the server would be open to others, KG541 unusable token, KG542 address in use.
    """
    check(options)
    app = create_app(settings, options)
    listening = listen(options)
    logs.configure()
    config = uvicorn.Config(
        app,
        http=guarded(options.connections, options.root_path),
        ws="none",
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
    )
    host = f"[{options.host}]" if ":" in options.host else options.host

    def begin() -> None:
        gc.freeze()  # the objects loaded so far are kept, so garbage collection need not look at them
        announce(f"http://{host}:{listening.getsockname()[1]}{options.root_path}/")

    Server(config, app, grace=options.grace, ready=begin).run(sockets=[listening])


def check(options: Options) -> None:
    """Refuse options that would open the server to others by accident.

    Raises:
        UsageError: KG540 other machines could read without a token, KG541 the token is missing or unusable, KG002
            disallowed origins.
    """
    given = options.token is not None or options.token_file is not None
    token = Tokens(options.token, options.token_file).current
    usable = token and len(token) >= LEAST and token.isascii() and token.isprintable() and " " not in token
    if given and not usable:
        where = f"the file {options.token_file}" if options.token_file else "KG_TOKEN"
        raise UsageError("KG541", f"{where} holds no token of at least {LEAST} characters")
    if options.write and not given:
        raise UsageError("KG541", "write access needs a token, but none is set")
    if not is_loopback(options.host) and not given and not options.open_to_all:
        raise UsageError("KG540", f"{options.host} is reachable from other machines, but no token is set")
    for origin in options.origins:
        scheme, _, host = origin.partition("://")
        if scheme not in {"http", "https"} or not host or set(host) & set("/?#@* "):
            hint = "List origins one by one, as in `--cors https://example.org`."
            raise UsageError("KG002", f"{origin!r} is not an origin of a site", hint=hint)


def listen(options: Options) -> socket.socket:
    """Return a listening socket for the options; UsageError KG542 if the address is not available."""
    if not 0 <= options.port < 1 << 16:
        raise UsageError("KG542", f"{options.port} is not a port", hint="Ports go from 0, for a free one, to 65535.")
    try:
        family, kind, _, _, address = socket.getaddrinfo(
            options.host.strip("[]"), options.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.socket(family, kind)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(address)
        listening.listen(512)
    except OSError as error:
        message = f"cannot listen at {options.host} port {options.port}: {error.strerror or error}"
        raise UsageError("KG542", message) from error
    return listening
