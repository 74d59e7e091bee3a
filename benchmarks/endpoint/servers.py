"""The servers that are measured: `kg serve` and Oxigraph's, each while a context lasts, on a port that was free."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

__all__ = ["kg", "oxigraph"]


@contextmanager
def oxigraph(location: Path) -> Iterator[int]:
    """Serve a store of Oxigraph; yield the port."""
    port = _free_port()
    command = ["oxigraph", "serve-read-only", "--location", str(location), "--union-default-graph"]
    with _running([*command, "--bind", f"127.0.0.1:{port}", "--timeout-s", "30"], port):
        yield port


@contextmanager
def kg(store: Path, *flags: str) -> Iterator[int]:
    """Serve a store of `kg`; yield the port."""
    port = _free_port()
    command = [sys.executable, "-m", "kg", "serve", "--store", str(store), "--port", str(port), "--log", "off"]
    with _running([*command, *flags], port):
        yield port


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port: int = free.getsockname()[1]
        return port


@contextmanager
def _running(command: Sequence[str], port: int) -> Iterator[None]:
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        for _ in range(600):
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                time.sleep(0.1)
        yield
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(15)
        except subprocess.TimeoutExpired:
            process.kill()
