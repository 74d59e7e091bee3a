"""Something to connect to: a plain session of Zenoh that listens on loopback, without multicast, and is no router."""

from __future__ import annotations

import json
import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING

import zenoh

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["free_port", "hub", "session"]


def free_port() -> int:
    """Return a port that nobody has."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port: int = one.getsockname()[1]
        return port


def session(**settings: object) -> zenoh.Session:
    """Open a session that neither asks the network nor is found by it."""
    config = zenoh.Config()
    told = {"mode": "peer", "scouting/multicast/enabled": False, "timestamping/enabled": True}
    for key, value in {**told, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


@contextmanager
def hub() -> Iterator[tuple[str, zenoh.Session]]:
    """Give the place of a peer, and the peer itself."""
    place = f"127.0.0.1:{free_port()}"
    with session(**{"listen/endpoints": [f"tcp/{place}"]}) as peer:
        yield place, peer
