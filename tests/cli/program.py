"""The program as users run it: a process with streams and an exit code of its own."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from select import select
from signal import SIGKILL
from typing import TYPE_CHECKING, Final

from cli import forking
from cli.forking import ANSWER
from patience import patient

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

__all__ = ["Program", "Run"]

_SECONDS: Final = 30
"""Time limit in seconds of a run on an idle machine."""
_READ_LATER: Final = {"KG_STORE", "KG_JOBS", "KG_TOKEN"}
"""Variables that no module reads at import."""
_serving: Final[list[tuple[subprocess.Popen[bytes], socket.socket]]] = []
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
    socket.send_fds(_server(), [json.dumps(order).encode()], [there for _, there in pipes])
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


def _server() -> socket.socket:
    """Return the socket of the fork server; start it if it is not running."""
    if not _serving or _serving[-1][0].poll() is not None:
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with there:
            command = [sys.executable, "-P", forking.__file__, str(there.fileno())]
            process = subprocess.Popen(command, env=_surroundings({}), pass_fds=[there.fileno()])
        _serving.append((process, here))
    return _serving[-1][1]
