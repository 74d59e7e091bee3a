"""What tests of the server share: an application in this process, and a server in one of its own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from patience import patient
from starlette.testclient import TestClient

from kg.server.app import create_app
from kg.server.options import Options
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

__all__ = ["ADDRESS", "EVERYWHERE", "TOKEN", "UNASKED", "Serving", "application", "served"]

ADDRESS: Final = "http://127.0.0.1:7878"
"""What an application in this process is asked as."""
EVERYWHERE: Final = "0.0.0.0"  # noqa: S104 - given to options; no test listens there
"""A host that other machines reach."""
TOKEN: Final = "correct-horse-battery-staple"  # noqa: S105 - of a test
"""The token of servers that have one."""
UNASKED: Final = "from kg.query.readers import pool\npool._PREPARE_SECONDS = 3600.0\n"
"""Run before a server, it keeps readers from work that nobody asked for, where tests look for who is at work."""

_SECONDS: Final = 30
"""The deadline of queries, which is that of a server of which nothing is said where the machine is idle."""

_PROGRAM: Final = """
import json, sys
from pathlib import Path
{before}
from kg.server.options import Options
from kg.server.running import serve
from kg.settings import load
named = json.loads(sys.argv[2])
named.update((name, Path(named[name])) for name in ("token_file", "slow_log") if named.get(name))
serve(load({{"store": sys.argv[1]}}), Options(**named), lambda address: print(address, flush=True))
"""


@contextmanager
def application(store: Path, address: str = ADDRESS, **options: Any) -> Iterator[TestClient]:
    """Yield a client of an application in this process that serves the store; queries have time on a busy machine."""
    named = {"seconds": patient(_SECONDS), **options}
    app = create_app(load({"store": str(store)}, environment={}), Options(**named))
    with TestClient(app, base_url=address, follow_redirects=False, raise_server_exceptions=False) as client:
        yield client


@dataclass(frozen=True, slots=True)
class Serving:
    """A server that runs: its address without the last slash, its port and its process."""

    address: str
    port: int
    process: subprocess.Popen[str]

    def stop(self, seconds: float = 30) -> tuple[int, str]:
        """Tell the server to stop; return its exit code and what it said on standard error."""
        self.process.send_signal(signal.SIGTERM)
        _, said = self.process.communicate(timeout=patient(seconds))
        return self.process.returncode, said


@contextmanager
def served(
    store: Path, *, before: str = "", environment: Mapping[str, str] | None = None, **options: Any
) -> Iterator[Serving]:
    """Run a server on a free port, as `application`; `before` is Python that its process runs first."""
    given = {"port": 0, "seconds": patient(_SECONDS), **options}
    named = {name: str(value) if hasattr(value, "parts") else value for name, value in given.items()}
    process = subprocess.Popen(
        [sys.executable, "-c", _PROGRAM.format(before=before), str(store), json.dumps(named)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **(environment or {})},
    )
    assert process.stdout is not None
    try:
        address = process.stdout.readline().strip().rstrip("/")
        if not address:
            raise AssertionError(process.communicate(timeout=patient(30))[1])
        yield Serving(address, int(address.rpartition(":")[2]), process)
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()
