"""Ports of this machine for programs that cannot start on port 0."""

from __future__ import annotations

import random
import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["own_port"]

_PORTS: Final = range(20_000, 32_000, 2)
"""Below the range used by the system for port 0 and outgoing connections (Linux: from 32768)."""


@contextmanager
def own_port() -> Iterator[int]:
    """Yield a free TCP port reserved for this block: the port above it is held as a lock."""
    for port in random.sample(_PORTS, len(_PORTS)):
        with socket.socket() as lock:
            try:
                lock.bind(("127.0.0.1", port + 1))
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            yield port
            return
    raise AssertionError("no free port")
