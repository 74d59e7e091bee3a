"""The servers that are measured: `kg serve` and Oxigraph's, each while a context lasts, on a port that was free."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["Served", "kg", "oxigraph"]

_TICK: Final = 1 / os.sysconf("SC_CLK_TCK")


class Served(NamedTuple):
    """A server that runs: its port, and its process."""

    port: int
    pid: int

    def processor(self) -> float:
        """Return the processor seconds of the process and of all below it, those that have ended included."""
        below: dict[int, list[tuple[int, int]]] = {}
        for path in Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = path.read_text().rsplit(")", 1)[1].split()
            except OSError:  # it has ended
                continue
            one = int(path.parent.name)
            below.setdefault(int(fields[1]), []).append((one, sum(map(int, fields[11:15]))))
            if one == self.pid:
                ticks = sum(map(int, fields[11:15]))
        parents = [self.pid]
        while parents:
            found = below.get(parents.pop(), [])
            ticks += sum(used for _, used in found)
            parents += [one for one, _ in found]
        return ticks * _TICK


@contextmanager
def oxigraph(location: Path) -> Iterator[Served]:
    """Serve a store of Oxigraph; yield it. With a timeout it starts a thread for each query, of which it dies here."""
    port = _free_port()
    command = ["oxigraph", "serve-read-only", "--location", str(location), "--union-default-graph"]
    with _running([*command, "--bind", f"127.0.0.1:{port}"], port) as pid:
        yield Served(port, pid)


@contextmanager
def kg(store: Path, *flags: str) -> Iterator[Served]:
    """Serve a store of `kg`; yield it."""
    port = _free_port()
    command = [sys.executable, "-m", "kg", "serve", "--store", str(store), "--port", str(port), "--log", "off"]
    with _running([*command, *flags], port) as pid:
        yield Served(port, pid)


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port: int = free.getsockname()[1]
        return port


@contextmanager
def _running(command: Sequence[str], port: int) -> Iterator[int]:
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        for _ in range(600):
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                time.sleep(0.1)
        yield process.pid
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(15)
        except subprocess.TimeoutExpired:
            process.kill()
