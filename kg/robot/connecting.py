"""Connections by address: the scheme says which middleware; its module is loaded when it is asked for."""

from __future__ import annotations

import os
import re
from importlib import import_module
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

from kg.errors import RobotError

if TYPE_CHECKING:
    from kg.robot.connection import Connection
    from kg.robot.messages import Types

__all__ = ["SCHEMES", "connect", "default_address", "is_recording", "not_commanded", "scheme_of"]

SCHEMES: Final = {
    "ros1": "kg.robot.ros1",
    "dds": "kg.robot.dds",
    "zenoh": "kg.robot.zenoh",
    "bag": "kg.robot.bag",
    "ws": "kg.robot.ws",
    "wss": "kg.robot.ws",
    "memory": "kg.robot.memory",
}
"""The module of each scheme; it has `async connect(address, name, types) -> Connection`."""


def default_address() -> str:
    """Return the address that the environment names: `$ROS_MASTER_URI`, or `$ROS_DOMAIN_ID` where ROS 2 is set up.

    There `$RMW_IMPLEMENTATION` says whether Zenoh is spoken, and `$ROS_DISTRO` which discovery messages are.
    """
    if os.environ.get("ROS_VERSION") == "2":
        domain = os.environ.get("ROS_DOMAIN_ID") or "0"
        if os.environ.get("RMW_IMPLEMENTATION") == "rmw_zenoh_cpp":
            return f"zenoh://localhost:7447?domain={domain}"
        before_iron = os.environ.get("ROS_DISTRO") in {"foxy", "galactic", "humble"}
        return f"dds://{domain}" + "?distribution=humble" * before_iron
    master = urlsplit(os.environ.get("ROS_MASTER_URI") or "http://localhost:11311")
    return f"ros1://{master.netloc}"


async def connect(address: str, *, name: str = "/kg", types: Types | None = None) -> Connection:
    """Become a node of the system at an address; `types` are message types that are known beforehand.

    Raises:
        RobotError: KG801 for an address of another form or a middleware that is not installed, KG802 when nothing
            answers there.
    """
    opened: Connection = await import_module(SCHEMES[scheme_of(address)]).connect(address, name, types)
    return opened


def scheme_of(address: str) -> str:
    """Return the scheme of an address; RobotError KG801 for one of another form."""
    scheme = address.partition(":")[0]
    if scheme not in SCHEMES:
        known = ", ".join(f"{one}://" for one in SCHEMES if one not in {"memory", "wss"})
        raise RobotError("KG801", f"`{address}` is not an address of a robot", hint=_meant(address, known))
    return scheme


def is_recording(address: str) -> bool:
    """Tell whether an address is that of a recording, which cannot be commanded."""
    return address.startswith("bag:")


def not_commanded(address: str) -> RobotError:
    """Return the error of who commands a recording (KG851)."""
    return RobotError("KG851", f"{address} is a recording: it can be read, not commanded")


def _meant(address: str, known: str) -> str:
    """Return what to write in place of an address: the master's, where it is given as $ROS_MASTER_URI has it."""
    if address.endswith((".bag", ".mcap", ".db3")):
        return f"A recording is written bag://{address}."
    host = address.removeprefix("http://").rstrip("/")
    if host != address.rstrip("/") or re.fullmatch(r"[\w.-]+:\d+", host):
        return f"A master of ROS 1 is written ros1://{host}."
    return f"An address begins with {known}."
