"""Connecting to robots by address, and a first look at their graph.

The scheme of an address names the middleware, whose module is loaded on first use. Nodes of ROS itself, such as
`/rosout`, are infrastructure and do not count as the robot's.
"""

from __future__ import annotations

import asyncio
import os
import re
from contextlib import asynccontextmanager
from dataclasses import replace
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Final
from urllib.parse import parse_qsl, urlsplit

from kg.errors import RobotError
from kg.resources import table_of

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Mapping

    from kg.robot.connection import ComputationGraph, Connection
    from kg.robot.messages import Types
    from kg.settings import Settings


def of_robot(graph: ComputationGraph) -> ComputationGraph:
    """Return a computation graph without the nodes that `ontology/implicit.toml` lists as infrastructure."""
    pattern = _pattern(graph.ros)
    if not any(pattern.fullmatch(one.name) for one in graph.nodes):
        return graph
    return replace(
        graph,
        nodes=tuple(one for one in graph.nodes if not pattern.fullmatch(one.name)),
        ends=tuple(one for one in graph.ends if not pattern.fullmatch(one.node)),
        problems=tuple(one for one in graph.problems if not pattern.fullmatch(one.subject)),
    )


@cache
def _pattern(ros: int) -> re.Pattern[str]:
    rows = (row for row in table_of("ontology", "implicit.toml")["infrastructure"] if row.get("ros", ros) == ros)
    return re.compile("|".join(f"(?:{row['pattern']})" for row in rows))


SCHEMES: Final = {
    "ros1": "kg.robot.ros1",
    "dds": "kg.robot.dds",
    "rclpy": "kg.robot.rclpy",
    "zenoh": "kg.robot.zenoh",
    "bag": "kg.robot.bag",
    "ws": "kg.robot.ws",
    "wss": "kg.robot.ws",
    "memory": "kg.robot.memory",
}
"""The module of each scheme; it has `async connect(address, name, types) -> Connection`."""


_DISCOVERING: Final = {"dds", "rclpy", "zenoh"}


def default_address() -> str:
    """Return the address from the environment: `$ROS_MASTER_URI`, or `$ROS_DOMAIN_ID` if ROS 2 is set up.

    For ROS 2, `$RMW_IMPLEMENTATION` selects Zenoh, and `$ROS_DISTRO` the form of discovery messages.
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
    """Join the system at an address as a node; `types` are known message types.

    Raises:
        RobotError: KG801 an invalid address or missing middleware, KG802 no answer.
    """
    opened: Connection = await import_module(SCHEMES[scheme_of(address)]).connect(address, name, types)
    return opened


def scheme_of(address: str) -> str:
    """Return the scheme of an address; RobotError KG801 for an invalid one."""
    scheme = address.partition(":")[0]
    if scheme not in SCHEMES:
        raise RobotError("KG801", f"`{address}` is not an address of a robot", hint=_suggestion(address))
    return scheme


def options(address: str, query: str, valid_options: Mapping[str, str]) -> dict[str, str]:
    """Return the options in the query of an address, by name; `valid_options` has their descriptions.

    Raises:
        RobotError: KG801 an unknown option.
    """
    given = dict(parse_qsl(query, keep_blank_values=True))
    if unknown := given.keys() - valid_options.keys():
        valid = ", ".join(f"{name}= ({what})" for name, what in valid_options.items())
        raise RobotError("KG801", f"`{address}` has an option `{min(unknown)}`", hint=f"Valid: {valid}.")
    return given


def number(address: str, text: str, hint: str) -> float:
    """Return a number in an address; RobotError KG801 with the hint for another text."""
    if not text.replace(".", "", 1).isdecimal() or not text.isascii():
        raise RobotError("KG801", f"`{address}`: `{text}` is not a number", hint=hint)
    return float(text)


def is_recording(address: str) -> bool:
    """Return whether an address is that of a recording, which cannot be commanded."""
    return address.startswith("bag:")


def is_discovered(address: str) -> bool:
    """Return whether the nodes at an address are discovered, and disappear when they leave or cannot be reached."""
    return scheme_of(address) in _DISCOVERING


def not_commanded(address: str) -> RobotError:
    """Return the error for commands to a recording (KG851)."""
    return RobotError("KG851", f"{address} is a recording: it can be read, not commanded")


def lost(address: str, why: str) -> RobotError:
    """Return the error for a lost robot (KG803), or for a recording that has ended."""
    if is_recording(address):
        hint = "Run the command again: each one plays the recording from its beginning."
        return RobotError("KG803", f"{address}: {why}", hint=hint)
    return RobotError("KG803", f"the robot at {address} is lost: {why}")


def _suggestion(address: str) -> str:
    """Return how to write an address: of a file, in the form of `$ROS_MASTER_URI`, or else in general."""
    if address.endswith((".bag", ".mcap", ".db3")):
        return f"A recording is written bag://{address}."
    host = address.removeprefix("http://").rstrip("/")
    if host != address.rstrip("/") or re.fullmatch(r"[\w.-]+:\d+", host):
        return f"A master of ROS 1 is written ros1://{host}."
    return f"An address begins with {', '.join(f'{one}://' for one in SCHEMES if one not in {'memory', 'wss'})}."


_DISCOVERED: Final = 2  # the version of ROS whose nodes are discovered over time, since no master lists them


def address_of(settings: Settings) -> str:
    """Return the address of the robot: that of the settings, else that of the environment."""
    return settings.robot or default_address()


@asynccontextmanager
async def connected(address: str) -> AsyncIterator[Connection]:
    """Join the system at an address as a node with a unique name, inside the context.

    Raises:
        RobotError: KG801 an invalid address, KG802 no answer.
    """
    connection = await connect(address, name=f"/kg_{os.getpid()}")
    try:
        yield connection
    finally:
        await connection.aclose()


async def inhabited(connection: Connection) -> ComputationGraph:
    """Return the computation graph of a robot; RobotError KG802 if it has no nodes of its own.

    A master without a robot still answers, and lists `/rosout`. Any DDS domain can be joined: one without nodes is a
    wrong number, or its robot is not running. Our own nodes and those of ROS itself do not count.
    """
    loop = asyncio.get_running_loop()
    begun = loop.time()
    graph = of_robot(await connection.graph())
    if not graph.nodes:
        waited = f" within {max(1, round(loop.time() - begun))} s" if graph.ros == _DISCOVERED else ""
        raise RobotError("KG802", f"no node was found at {connection.address}{waited}")
    return graph


async def look(address: str) -> ComputationGraph:
    """Return the computation graph of the system at an address; raises as `connected` and `inhabited`."""
    async with connected(address) as connection:
        return await inhabited(connection)
