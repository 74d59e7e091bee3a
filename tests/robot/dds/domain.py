"""A DDS domain for tests: loopback only, no multicast, and an unused number."""

from __future__ import annotations

import os
import random
import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["ISOLATED", "domain"]

ISOLATED = (
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast>"
    "<Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>30</MaxAutoParticipantIndex>"
    "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>"
)
_NUMBERS = range(1, 230)
_FIRST, _PORTS = 7400, 250
"""The first port of domain 0, and the ports per domain (DDSI-RTPS 2.5, 9.6.2); participants take the lowest."""


@contextmanager
def _own() -> Iterator[int]:
    """Reserve a domain number among all test processes of the machine: each holds the last port of its domain."""
    for number in random.sample(_NUMBERS, len(_NUMBERS)):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as held:
            try:
                held.bind(("127.0.0.1", _FIRST + _PORTS * (number + 1) - 1))
            except OSError:
                continue
            yield number
            return
    raise AssertionError("all domains are taken")


@contextmanager
def domain() -> Iterator[int]:
    """Yield the number of a domain visible only to participants created within."""
    before = os.environ.get("CYCLONEDDS_URI")
    os.environ["CYCLONEDDS_URI"] = ISOLATED
    try:
        with _own() as number:
            yield number
    finally:
        if before is None:
            del os.environ["CYCLONEDDS_URI"]
        else:
            os.environ["CYCLONEDDS_URI"] = before
