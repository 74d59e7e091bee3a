"""Names and addresses of ROS 1, with their validation (wiki.ros.org/Names)."""

from __future__ import annotations

import os
import re
import socket
from typing import Final
from urllib.parse import urlsplit

from kg.errors import RobotError
from kg.robot.messages import definitions

_NAME: Final = re.compile(r"/(?:[A-Za-z][A-Za-z0-9_]*(?:/[A-Za-z0-9_]+)*)?")
_HOST: Final = re.compile(r"[A-Za-z0-9_-]{1,63}(?:\.[A-Za-z0-9_-]{1,63})*\.?|[0-9A-Fa-f]*:[0-9A-Fa-f:.%]*")
_MOST_CHARACTERS: Final = 255
_LOOPBACK: Final = ("localhost", "127.", "::1")


def is_name(value: object) -> bool:
    """Return whether a value from a peer is an absolute name of the graph."""
    return isinstance(value, str) and len(value) <= _MOST_CHARACTERS and _NAME.fullmatch(value) is not None


def is_type(value: object) -> bool:
    """Return whether a value from a peer is a type, `package/Type`."""
    return isinstance(value, str) and len(value) <= _MOST_CHARACTERS and definitions.is_type(value)


def absolute(name: str) -> str:
    """Return one of our names as an absolute one; RobotError KG812 if it is invalid."""
    full = name if name.startswith("/") else f"/{name}"
    if not is_name(full) or full == "/":
        raise RobotError("KG812", f"`{shown(name)}` is not a ROS name", hint="Write letters, digits, `_` and `/`.")
    return full


def shown(value: object) -> str:
    """Return a value from a peer for a message: short, on one line."""
    text = value if isinstance(value, str) else repr(value)
    return "".join(sign if sign.isprintable() else "?" for sign in text[:80])


def peer(uri: object, scheme: str = "http") -> tuple[str, int]:
    """Return host and port in the address of a peer; RobotError KG812 for an invalid one."""
    try:
        parts = urlsplit(_bracketed(uri) if isinstance(uri, str) and len(uri) <= _MOST_CHARACTERS else "")
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if host is None or not port or parts.scheme != scheme or _HOST.fullmatch(host) is None:
        raise RobotError("KG812", f"`{shown(uri)}` is not an address of a node: {scheme}://HOST:PORT is one")
    return host, port


def _bracketed(uri: str) -> str:
    """Return an address with an IPv6 address in brackets, which rospy leaves out: `http://::1:4711/`."""
    scheme, sign, behind = uri.partition("://")
    place, slash, path = behind.partition("/")
    host, _, port = place.rpartition(":")
    return f"{scheme}{sign}{netloc(host, port)}{slash}{path}" if ":" in host and not {"[", "]"} & {*host} else uri


def netloc(host: str, port: int | str) -> str:
    """Return host and port as written in addresses: an IPv6 address in brackets."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def listening(host: str) -> str:
    """Return the listening address for a host name that peers use: loopback only for a loopback name.

    For an IPv6 address, or with `$ROS_IPV6` set to `on`, it is that of both protocols (`::`).
    """
    if host == "::1":
        return host
    if host.startswith(_LOOPBACK) and not _ipv6():
        return "127.0.0.1"
    return "::" if _ipv6() or ":" in host else "0.0.0.0"  # noqa: S104 - peers on other machines have to reach us


def _ipv6() -> bool:
    return os.environ.get("ROS_IPV6") == "on"


def own_host(master: str, port: int) -> str:
    """Return our host name for peers: `$ROS_HOSTNAME`, `$ROS_IP`, or the address used to reach the master.

    The order is that of wiki.ros.org/ROS/EnvironmentVariables.
    """
    for variable in ("ROS_HOSTNAME", "ROS_IP"):
        if host := os.environ.get(variable):
            return host
    if master.startswith(_LOOPBACK):
        return master
    try:
        ways = socket.getaddrinfo(master, port, type=socket.SOCK_DGRAM)
        family, *_, address = min(ways, key=lambda way: (way[0] == socket.AF_INET6) != _ipv6())
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.connect(address)
            return str(probe.getsockname()[0])
    except OSError:
        return socket.gethostname()
