"""A plain Zenoh peer to connect to, which listens on loopback, without multicast, and is not a router."""

from __future__ import annotations

import json
from contextlib import contextmanager
from typing import TYPE_CHECKING

import zenoh
from ports import own_port

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["hub", "session"]


def session(**settings: object) -> zenoh.Session:
    """Open a session without discovery in either direction."""
    config = zenoh.Config()
    told = {"mode": "peer", "scouting/multicast/enabled": False, "timestamping/enabled": True}
    for key, value in {**told, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


@contextmanager
def hub() -> Iterator[tuple[str, zenoh.Session]]:
    """Yield the address of a peer, and the peer itself."""
    with own_port() as port, session(**{"listen/endpoints": [f"tcp/127.0.0.1:{port}"]}) as peer:
        yield f"127.0.0.1:{port}", peer
