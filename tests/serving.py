"""Shared by tests of the server: an application in this process, and a server in a process of its own."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any, Final
from unittest.mock import patch
from urllib.parse import urlsplit

from forks import READERS, address, fork_readers, start
from patience import patient
from repository import ROOT
from starlette.testclient import TestClient

from kg.query.readers import pool
from kg.server.app import create_app
from kg.server.options import Options
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import httpx
    from forks import Forked

__all__ = ["ADDRESS", "EVERYWHERE", "TOKEN", "Serving", "application", "robot_told", "served"]

ADDRESS: Final = "http://127.0.0.1:7878"
"""The address of an application in this process."""
EVERYWHERE: Final = "0.0.0.0"  # noqa: S104 - given to options; no test listens there
"""A host reachable from other machines."""
TOKEN: Final = "correct-horse-battery-staple"  # noqa: S105 - of a test
"""The token of servers that require one."""
_UNASKED: Final = 3600.0
"""Seconds until readers prepare for requests, which takes a second of processor time and is work that tests count."""
_SECONDS: Final = 30
"""The deadline of queries in seconds: the default of a server, on an idle machine."""

_BEGINNING: Final = 30
"""Time limit in seconds until a server prints its address."""

_MODULES: Final = ("kg.query.readers.pool", "kg.server.app", "kg.server.running")
"""Modules that a server imports at its start or with its first requests."""
_PROGRAM: Final = """
import faulthandler, gc, json, sys
from pathlib import Path
faulthandler.enable()
gc.set_threshold(100_000)  # as kg.cli.main does
from kg.query.readers import pool
pool._PREPARE_SECONDS = {unasked}
{before}
from kg.server.options import Options
from kg.server.running import serve
from kg.settings import load
named = json.loads(sys.argv[2])
named.update((name, Path(named[name])) for name in ("token_file", "slow_log") if named.get(name))
serve(load({{"store": sys.argv[1]}}), Options(**named), lambda address: print(address, flush=True))
"""
_FORK_READERS: Final = """
from kg.query.readers import processes
sys.path.insert(0, {tests!r})
from forks import fork_readers
sys.path.pop(0)
processes.subprocess = fork_readers({server!r})
"""


@contextmanager
def application(store: Path | str, base_url: str = ADDRESS, **options: Any) -> Iterator[TestClient]:
    """Yield a client of an application in this process, which serves a folder or the data of another server.

    The deadline of queries allows for a busy machine.
    """
    named = {"seconds": patient(_SECONDS), **options}
    app = create_app(load({"store": str(store)}, environment={}), Options(**named))
    with (
        patch.object(pool, "_PREPARE_SECONDS", _UNASKED),
        patch(f"{READERS}.subprocess", fork_readers()),
        TestClient(app, base_url=base_url, follow_redirects=False, raise_server_exceptions=False) as client,
    ):
        yield client


@dataclass(frozen=True, slots=True)
class Serving:
    """A running server: its address without the last slash, its port, its process and its standard error."""

    address: str
    port: int
    process: Forked | subprocess.Popen[str]
    said: IO[str]

    def stop(self, seconds: float = 30) -> tuple[int, str]:
        """Stop the server; return its exit code and its standard error."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(patient(seconds)), _read(self.said)


@contextmanager
def served(
    store: Path,
    *,
    before: str = "",
    environment: Mapping[str, str] | None = None,
    forks_readers: bool = True,
    **options: Any,
) -> Iterator[Serving]:
    """Run a server on a free port, as `application`; `before` is Python code that its process runs first.

    The process is forked. With `forks_readers` the parent of its readers is too, and is no child of the server.
    """
    given = {"port": 0, "seconds": patient(_SECONDS), **options}
    named = {name: str(value) if hasattr(value, "parts") else value for name, value in given.items()}
    if forks_readers:
        before = _FORK_READERS.format(tests=str(ROOT / "tests"), server=address()) + before
    program = _PROGRAM.format(unasked=_UNASKED, before=before)
    # Into a file: an unread pipe fills up and blocks its writer.
    with tempfile.TemporaryFile("a+", encoding="utf-8") as said, start(
        *("-c", program, str(store), json.dumps(named)),
        environment={**os.environ, **(environment or {})},
        streams=(subprocess.DEVNULL, subprocess.PIPE, said),
        modules=_MODULES,
    ) as process:  # fmt: skip
        try:
            found = _address(process, said)
            yield Serving(found, urlsplit(found).port or 0, process, said)
        finally:
            process.kill()


def _address(process: Forked | subprocess.Popen[str], said: IO[str]) -> str:
    """Return the address that a server prints; without one, its output and its state."""
    assert process.stdout is not None
    seconds = patient(_BEGINNING)
    waited = not select.select([process.stdout], [], [], seconds)[0]
    if not waited and (address := process.stdout.readline().strip().rstrip("/")):
        return address
    if waited:
        process.send_signal(signal.SIGABRT)
    process.wait(patient(_BEGINNING))
    raise AssertionError(f"no address within {seconds:.0f} s:\n{_read(said)}" if waited else _read(said))


def _read(said: IO[str]) -> str:
    said.seek(0)
    return said.read()


def robot_told(client: httpx.Client, wanted: str, part: str = "program") -> dict[str, Any]:
    """Return the server's state of the robot, once the robot or its program reaches a state."""
    end = time.monotonic() + patient(20)
    while time.monotonic() < end:
        told: dict[str, Any] = client.get("/api/robot").json()
        if (told["program"] if part == "program" else told)["state"] == wanted and told["capabilities"]:
            return told
        time.sleep(0.05)
    raise AssertionError(f"the {part} is never {wanted}: {told}")
