"""Addresses of ROS 2 systems: `dds://DOMAIN` or `zenoh://HOST:PORT`, with options after a question mark."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final
from urllib.parse import urlsplit

from kg.errors import RobotError
from kg.robot.connecting import number, options

_SETTLE: Final = 5.0
"""Seconds until a discovered graph counts as complete. The lease of a participant is 10 s, and running participants
announce themselves to a new one at once.
"""
QUIET: Final = 1.5
"""Seconds without a change after which a graph with nodes counts as complete before that. A node announces its ends
within a fraction of a second; the tools of ROS 2 wait for half a second altogether.
"""

_OPTIONS: Final = {
    "clock": "wall or simulated",
    "settle": "seconds",
    "domain": "the number of a ROS domain",
    "distribution": "humble",
    "types": "peers",
}
_MAXIMUM: Final = 232  # maximum domain number: higher ones would have invalid ports (DDSI-RTPS 2.5, 9.6.2)
_NUMBERS: Final = f"A domain is a number from 0 to {_MAXIMUM}, as in dds://0; settle is one of seconds."


@dataclass(frozen=True, slots=True)
class Address:
    """A parsed address.

    `place` is the part after the scheme. `simulated` uses the time of `/clock`; `settle` is the number of seconds until
    the graph counts as complete; without it, `quiet` seconds without a change are enough. `humble` marks a system of
    Humble or earlier, with identifiers of 24 bytes; without it, kg uses that length while another participant does.
    `ask_types` requests unknown types from peers over DDS, which crashes Cyclone DDS before 11.
    """

    text: str
    place: str
    domain: int = 0
    simulated: bool = False
    settle: float = _SETTLE
    quiet: float | None = None
    humble: bool = False
    ask_types: bool = False

    @classmethod
    def read(cls, text: str) -> Address:
        """Return a parsed address; RobotError KG801 for an unknown option or invalid value."""
        try:
            parts = urlsplit(text)
        except ValueError as error:
            raise RobotError("KG801", f"`{text}` is not an address: {error}") from None
        given = options(text, parts.query, _OPTIONS)
        if given.get("distribution", "humble") != "humble":
            message = f"`{text}` names the distribution `{given['distribution']}`"
            raise RobotError("KG801", message, hint="Only humble has to be named; leave it out.")
        if given.get("types", "peers") != "peers":
            raise RobotError("KG801", f"`{text}` asks `{given['types']}` for types", hint="Write types=peers.")
        if given.get("clock", "wall") not in {"wall", "simulated"}:
            raise RobotError(
                "KG801", f"`{text}` asks for a clock `{given['clock']}`", hint="Write clock=wall or clock=simulated."
            )
        place = parts.netloc + parts.path.rstrip("/")
        text_of_domain = given.get("domain") or (place if parts.scheme in {"dds", "rclpy"} else "0") or "0"
        domain = number(text, text_of_domain, _NUMBERS)
        if domain > _MAXIMUM or domain != int(domain):
            raise RobotError(
                "KG801", f"`{text}`: ROS domain {domain:g} does not exist", hint=f"They are 0 to {_MAXIMUM}."
            )
        return cls(
            text,
            place,
            int(domain),
            simulated=given.get("clock") == "simulated",
            settle=number(text, given.get("settle") or str(_SETTLE), _NUMBERS),
            quiet=None if given.get("settle") else QUIET,
            humble="distribution" in given,
            ask_types="types" in given,
        )
