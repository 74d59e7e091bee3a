"""Programs of tests as processes forked from one that has imported `kg`: a new Python takes a second of imports."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from select import select
from tempfile import mkdtemp
from types import SimpleNamespace
from typing import IO, TYPE_CHECKING, Any, Final

import forking
from forking import ANSWER

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Self

__all__ = ["EXTRACTING", "READERS", "Forked", "address", "fork_extractors", "fork_readers", "programs", "start"]

READERS: Final = "kg.query.readers.processes"
"""The module that starts the fork servers of readers."""
EXTRACTING: Final = "kg.pipeline.extracting"
"""The module that starts the extractors of a cluster's workers."""
_FORK_SERVER: Final = "kg.query.readers.forkserver"
_VIEWS: Final = "kg.views.calls"

_SOCKET: Final = "socket"
"""The name of the socket of a fork server, in the folder of its programs."""
_CALLER: Final = """#!{python} -IS
import os, socket, sys
here, there = os.pipe()
order = {{"python": ["-m", "kg", *sys.argv[1:]], "folder": os.getcwd(), "environment": dict(os.environ)}}
with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as server:
    server.connect({address!r})
    socket.send_fds(server, [__import__("json").dumps(order).encode()], [1, 2, there, 0])
os.close(there)
with open(here, "rb") as answers:
    code = int.from_bytes(answers.read()[4:], "big", signed=True)
sys.exit(code if code >= 0 else 128 - code)
"""
"""Sends its command to the fork server and exits as the forked process does."""


@dataclass(slots=True)
class Forked:
    """A process of the fork server, with the parts of `subprocess.Popen` that tests use; streams are text."""

    pid: int
    stdin: IO[str] | None
    stdout: IO[str] | None
    stderr: IO[str] | None
    answers: IO[bytes]
    """The pipe on which the exit code arrives."""
    returncode: int | None = None

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the streams, and wait until the process has ended."""
        for stream in (self.stdin, self.stdout, self.stderr):
            if stream:
                stream.close()
        self.wait()
        self.answers.close()

    def poll(self) -> int | None:
        """Return the exit code, or None while the process runs."""
        if self.returncode is None and select([self.answers], [], [], 0)[0]:
            (self.returncode,) = ANSWER.unpack(self.answers.read(ANSWER.size))
            self.answers.close()
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Return the exit code once the process has ended; raises TimeoutExpired after some seconds."""
        if self.returncode is None:
            select([self.answers], [], [], timeout)
            if self.poll() is None:
                raise subprocess.TimeoutExpired("a forked process", timeout or 0)
        assert self.returncode is not None
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Send a signal, if the process still runs."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def terminate(self) -> None:
        """Ask the process to end."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """Kill the process."""
        self.send_signal(signal.SIGKILL)

    def communicate(self, timeout: float | None = None) -> tuple[str, str]:
        """Return what the process writes until it ends; a process that takes longer is killed, with TimeoutExpired."""
        if self.stdin:
            self.stdin.close()
        with ThreadPoolExecutor(2) as readers:
            said = [readers.submit(stream.read) if stream else None for stream in (self.stdout, self.stderr)]
            try:
                self.wait(timeout)
            except subprocess.TimeoutExpired:
                self.kill()
                raise
            out, err = (each.result() if each else "" for each in said)
        return out, err


@dataclass(frozen=True, slots=True)
class _Server:
    """A fork server: its process, the socket for orders, and the folder with the program `kg` that calls it."""

    process: subprocess.Popen[bytes]
    orders: socket.socket
    programs: Path


_serving: Final[list[_Server]] = []
"""The current fork server, as the last item; it stops with this process, or when a test stops it."""


def start(  # noqa: PLR0913 - as subprocess.Popen
    *python: str,
    folder: Path | None = None,
    environment: Mapping[str, str] | None = None,
    streams: tuple[int | IO[str] | None, ...] = (subprocess.DEVNULL, subprocess.PIPE, subprocess.PIPE),
    modules: Iterable[str] = (),
    builds: bool = False,
    session: bool = False,
    server: str = "",
) -> Forked | subprocess.Popen[str]:
    """Start Python with arguments, in a folder and with an environment, by default those of this process.

    `streams` are input, output and errors, as `subprocess` takes them. The process is forked from one that has imported
    `kg` and `modules`, with `builds` also what builds need; outside of Linux it is a new one. With `session` it has a
    session of its own. `server` is the address of the fork server of another process.
    """
    environment = dict(os.environ if environment is None else environment)
    given, output, errors = streams
    if sys.platform != "linux":
        command = [sys.executable, *python]
        return subprocess.Popen(
            command, cwd=folder, env=environment, text=True, stdin=given, stdout=output, stderr=errors,
            start_new_session=session,
        )  # fmt: skip
    order = {
        "python": python,
        "folder": str(folder or Path.cwd()),
        "environment": environment,
        "modules": list(modules),
        "builds": builds,
        "session": session,
    }
    (stdin, theirs), (stdout, out), (stderr, err) = (_ends(each, number) for number, each in enumerate(streams))
    answers, answering = os.pipe()
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as orders:
        orders.connect(server or address())
        socket.send_fds(orders, [json.dumps(order).encode()], [out, err, answering, theirs])
    for file, each in ((theirs, given), (out, output), (err, errors), (answering, subprocess.PIPE)):
        if isinstance(each, int):
            os.close(file)
    pipe = os.fdopen(answers, "rb", buffering=0)
    (number,) = ANSWER.unpack(pipe.read(ANSWER.size))
    return Forked(number, stdin, stdout, stderr, pipe)


def _ends(stream: int | IO[str] | None, number: int) -> tuple[IO[str] | None, int]:
    """Return this end and the other one of a stream, the standard stream `number` of the process."""
    if stream == subprocess.PIPE:
        read, write = os.pipe()
        return (os.fdopen(write, "w"), read) if number == 0 else (os.fdopen(read), write)
    if stream == subprocess.DEVNULL:
        return None, os.open(os.devnull, os.O_RDWR)
    return None, number if stream is None else stream if isinstance(stream, int) else stream.fileno()


def fork_readers(server: str = "") -> Any:
    """Return what replaces `subprocess` in the module `READERS`: fork servers of readers are forked.

    A new one imports for a second of processor time, most of it while it is idle. `server` as in `start`.
    """
    if sys.platform != "linux":
        return subprocess

    def begin(command: list[str], *, stdin: int, stderr: int, env: dict[str, str], **others: Any) -> Any:
        usual = [*import_module(READERS).PROGRAM]
        calls = command[len(usual) :]
        if command[: len(usual)] != usual or calls not in ([], [_VIEWS]):  # a test has its own
            return subprocess.Popen(command, stdin=stdin, stderr=stderr, env=env, **others)
        modules = [_FORK_SERVER, *calls, *(import_module(_VIEWS).MODULES if calls else ())]
        text = f"import sys; sys.argv[1:] = {calls}; from {_FORK_SERVER} import main; main()"
        streams = (os.dup(stdin), subprocess.DEVNULL, os.dup(stderr))
        return start("-c", text, environment=env, streams=streams, modules=modules, session=True, server=server)

    return SimpleNamespace(Popen=begin, DEVNULL=subprocess.DEVNULL)


def fork_extractors(started: list[Forked]) -> Any:
    """Return what replaces `subprocess` in the module `EXTRACTING`: extractors are forked, and added to `started`.

    A new one imports for a second of processor time. Only on Linux.
    """

    def begin(_: list[str], *, pass_fds: list[int], stdin: int) -> Forked | subprocess.Popen[str]:
        text = f"import os, sys; sys.argv[1:] = [str(os.dup(1))]; os.dup2(2, 1); from {EXTRACTING} import main; main()"
        streams = (stdin, os.dup(pass_fds[0]), None)
        process = start("-c", text, streams=streams, modules=[EXTRACTING], builds=True)
        assert isinstance(process, Forked)
        started.append(process)
        return process

    return SimpleNamespace(Popen=begin, PIPE=subprocess.PIPE, TimeoutExpired=subprocess.TimeoutExpired)


def address() -> str:
    """Return the address of the fork server, for processes that it forked; outside of Linux, it has none."""
    return str(programs() / _SOCKET) if sys.platform == "linux" else ""


def programs() -> Path:
    """Return a folder with a program `kg` for shells and subprocesses, which forks as `start` does.

    Signals to it do not reach the forked process.
    """
    return _server().programs


def _server() -> _Server:
    """Return the fork server; start it if it is not running."""
    if not _serving or _serving[-1].process.poll() is not None:
        folder = Path(mkdtemp(prefix="kg-forks-"))
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        program = folder / "kg"
        program.write_text(_CALLER.format(python=sys.executable, address=str(folder / _SOCKET)), encoding="utf-8")
        program.chmod(0o755)
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        clean = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
        with there, socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as callers:
            callers.bind(str(folder / _SOCKET))
            callers.listen()
            numbers = [there.fileno(), callers.fileno()]
            command = [sys.executable, "-P", forking.__file__, *map(str, numbers)]
            process = subprocess.Popen(command, env=clean | {"COLUMNS": "80"}, pass_fds=numbers)
        _serving.append(_Server(process, here, folder))
    return _serving[-1]
