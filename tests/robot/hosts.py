"""Hosts of their own: network namespaces that a cable connects to each other, or to the host of the tests."""

from __future__ import annotations

import os
import shutil
import subprocess
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["cable", "host", "missing", "on", "plug"]

_NETWORK: Final = "10.77.0"


def missing() -> str | None:
    """Return why this machine can make no hosts, None if it can."""
    if shutil.which("ip") is None:
        return "iproute2 is not installed"
    try:
        with host("probe"):
            return None
    except subprocess.CalledProcessError as error:
        return f"network namespaces cannot be made: {error.stderr.strip()}"


def on(name: str | None) -> tuple[str, ...]:
    """Return the words before a command that run it on a host; None is this host."""
    return () if name is None else ("ip", "netns", "exec", name)


@contextmanager
def host(role: str) -> Iterator[str]:
    """Make a host, and give its name."""
    name = f"kg-{role}-{os.getpid()}"
    _ip("netns", "add", name)
    try:
        _ip("-n", name, "link", "set", "lo", "up")
        yield name
    finally:
        _ip("netns", "del", name)


@contextmanager
def cable(one: str, other: str | None) -> Iterator[None]:
    """Connect a host to another, or to this one."""
    ends = f"kg{os.getpid()}a", f"kg{os.getpid()}b"
    elsewhere = () if other is None else ("netns", other)
    _ip("link", "add", ends[0], "netns", one, "type", "veth", "peer", "name", ends[1], *elsewhere)
    try:
        for number, (name, end) in enumerate(zip((one, other), ends, strict=True), 1):
            _ip(*_at(name), "addr", "add", f"{_NETWORK}.{number}/24", "dev", end)
            _ip(*_at(name), "link", "set", end, "up")
        yield
    finally:
        _ip("-n", one, "link", "del", ends[0])


def plug(name: str, state: str) -> None:
    """Put the cable of a host, the first of the two, `up` or `down`."""
    _ip("-n", name, "link", "set", f"kg{os.getpid()}a", state)


def _at(name: str | None) -> tuple[str, ...]:
    return () if name is None else ("-n", name)


def _ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True, capture_output=True, text=True)
