"""The program as users run it: a process with streams and an exit code of its own."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from select import select
from signal import SIGKILL
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Final

from cli import forking
from cli.forking import ANSWER
from patience import patient

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["Program", "Run", "programs"]

_SECONDS: Final = 30
"""Time limit in seconds of a run on an idle machine."""
_READ_LATER: Final = {
    *("COMP_CWORD", "COMP_WORDS", "KG_JOBS", "KG_REMOTE_PASSWORD", "KG_REMOTE_USER", "KG_STORE", "KG_TOKEN"),
    *("XDG_CACHE_HOME", "_KG_COMPLETE"),
}
"""Variables that no module reads at import."""
_CALLER: Final = """#!{python} -IS
import os, socket, sys
here, there = os.pipe()
order = {{"arguments": sys.argv[1:], "folder": os.getcwd(), "environment": dict(os.environ)}}
with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as server:
    server.connect({address!r})
    socket.send_fds(server, [__import__("json").dumps(order).encode()], [1, 2, there, 0])
os.close(there)
with open(here, "rb") as answers:
    code = int.from_bytes(answers.read()[4:], "big", signed=True)
sys.exit(code if code >= 0 else 128 - code)
"""
"""Sends its command to the fork server and exits as the forked process does."""


@dataclass(frozen=True, slots=True)
class _Server:
    """A fork server: its process, the socket for orders, and the folder with the program `kg` that calls it."""

    process: subprocess.Popen[bytes]
    orders: socket.socket
    programs: Path


_serving: Final[list[_Server]] = []
"""The current fork server, as the last item; it stops with this process, or when a test stops it."""


@dataclass(frozen=True, slots=True)
class Run:
    """The result of a process."""

    code: int
    out: str
    err: str


@dataclass(frozen=True, slots=True)
class Program:
    """Runs `kg` in `folder`, without outside settings."""

    folder: Path

    def __call__(self, *arguments: str, folder: Path | None = None, **environment: str) -> Run:
        """Run `kg` with arguments; `folder` is another working folder, other keywords are environment variables.

        The process is forked from one that has imported `kg`, unless variables are given that Python itself or a
        library may read at start.
        """
        if sys.platform == "linux" and environment.keys() <= _READ_LATER:
            return _forked(arguments, folder or self.folder, _surroundings(environment))
        return self.python("-m", "kg", *arguments, folder=folder, **environment)

    def python(self, *arguments: str, folder: Path | None = None, **environment: str) -> Run:
        """Run a new Python in the same environment."""
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=folder or self.folder,
            env=_surroundings(environment),
            capture_output=True,
            text=True,
            check=False,
            timeout=patient(_SECONDS),
        )
        return Run(done.returncode, done.stdout, done.stderr)


def _surroundings(environment: Mapping[str, str]) -> dict[str, str]:
    clean = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    return {**clean, "COLUMNS": "80", **environment}


def _forked(arguments: Sequence[str], folder: Path, environment: Mapping[str, str]) -> Run:
    order = {"arguments": arguments, "folder": str(folder), "environment": environment}
    pipes = [os.pipe() for _ in range(3)]
    socket.send_fds(_server().orders, [json.dumps(order).encode()], [there for _, there in pipes])
    for _, there in pipes:
        os.close(there)
    out, err, answers = (os.fdopen(here, mode) for (here, _), mode in zip(pipes, ("r", "r", "rb"), strict=True))
    with out, err, answers, ThreadPoolExecutor(2) as readers:
        said = [readers.submit(stream.read) for stream in (out, err)]
        (number,) = ANSWER.unpack(answers.read(ANSWER.size))
        seconds = patient(_SECONDS)
        if not select([answers], [], [], seconds)[0]:
            os.kill(number, SIGKILL)
            raise subprocess.TimeoutExpired(["kg", *arguments], seconds)
        (code,) = ANSWER.unpack(answers.read(ANSWER.size))
        return Run(code, said[0].result(), said[1].result())


def programs() -> Path:
    """Return a folder with a program `kg` for shells and subprocesses, which forks like `Program`.

    Signals to it do not reach the forked process.
    """
    return _server().programs


def _server() -> _Server:
    """Return the fork server; start it if it is not running."""
    if not _serving or _serving[-1].process.poll() is not None:
        folder = Path(mkdtemp(prefix="kg-forks-"))
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        address = str(folder / "socket")
        program = folder / "kg"
        program.write_text(_CALLER.format(python=sys.executable, address=address), encoding="utf-8")
        program.chmod(0o755)
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with there, socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as callers:
            callers.bind(address)
            callers.listen()
            numbers = [there.fileno(), callers.fileno()]
            command = [sys.executable, "-P", forking.__file__, *map(str, numbers)]
            process = subprocess.Popen(command, env=_surroundings({}), pass_fds=numbers)
        _serving.append(_Server(process, here, folder))
    return _serving[-1]
