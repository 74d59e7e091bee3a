"""Named places: their sources, and their substitution in programs.

A file of places is TOML, a table for each place: `kitchen = { x = 3.2, y = 1.0, heading = 90 }`, in metres and degrees
on the robot's map; z and heading are optional.
"""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import msgspec

from kg.errors import RobotError, UsageError
from kg.facts import Role
from kg.robot.programs import values
from kg.robot.programs.names import AT, takes_place
from kg.robot.programs.tree import For, Position, Program, Set, Written, rewritten, statements
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capability
    from kg.robot.connection import ComputationGraph, Connection

Places: TypeAlias = "Mapping[str, Position]"
"""Places by name; each component is a number with its unit."""
TOPIC: Final = "/simulator/places"
"""The topic on which a simulated robot publishes its places, as the text of a file of places."""
MOST: Final = 1 << 18
"""Maximum size in bytes of a file of places."""
_KIND: Final = "std_msgs/String"
_FIRST: Final = 3.0  # seconds to wait for the places of a robot


class _Place(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    x: float
    y: float
    z: float | None = None
    heading: float | None = None


def places_of(text: str | bytes) -> dict[str, Position]:
    """Return the places in the text of a file; ValueError with the reason if it is invalid."""
    try:
        table = msgspec.toml.decode(text, type=dict[str, Any])
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise ValueError(str(error)) from None
    places: dict[str, Position] = {}
    for name, given in table.items():
        try:
            read = msgspec.convert(given, _Place)
            places[name] = Position(
                x=Written(value=read.x, unit="m"),
                y=Written(value=read.y, unit="m"),
                z=None if read.z is None else Written(value=read.z, unit="m"),
                heading=None if read.heading is None else Written(value=read.heading, unit="deg"),
            )
        except ValueError as error:
            raise ValueError(f"`{name}`: {error}") from None
    return places


def read_places(path: str) -> dict[str, Position]:
    """Return the places in a file, none for the empty path; UsageError KG003 for an invalid file."""
    if not path:
        return {}
    try:
        with Path(path).open("rb") as file:
            return places_of(file.read(MOST))
    except OSError as error:
        raise UsageError("KG003", f"`{path}` cannot be read: {error.strerror}") from error
    except ValueError as error:
        hint = "A place is written `kitchen = { x = 3.2, y = 1.0, heading = 90 }`, in metres and degrees."
        raise UsageError("KG003", f"`{path}` is not a file of places: {error}", hint=hint) from error


def offers(graph: ComputationGraph) -> bool:
    """Return whether a simulated robot publishes places in a graph; not in a recording, which reading would start."""
    if graph.recorded:
        return False
    return any(one.role is Role.PUBLISHES and (one.name, one.type) == (TOPIC, _KIND) for one in graph.ends)


async def offered(connection: Connection, graph: ComputationGraph) -> dict[str, Position]:
    """Return the places that a simulated robot publishes, none for other robots; invalid ones are ignored."""
    if not offers(graph):
        return {}
    try:
        async with asyncio.timeout(_FIRST):
            subscription = await connection.subscribe(TOPIC, _KIND, queue=1)
            try:
                async for received in subscription:
                    return places_of(received.value["data"][:MOST])
            finally:
                await subscription.aclose()
    except (RobotError, TimeoutError, ValueError):
        return {}
    return {}


def placed(program: Program, places: Places) -> Program:
    """Return a program with places instead of their names, except for names that it assigns itself."""
    own = {one.variable for _, one in statements(program.body) if isinstance(one, Set | For)}
    by_name = {name: msgspec.to_builtins(place) for name, place in places.items() if name not in own}
    if not by_name:
        return program

    def change(part: dict[str, Any]) -> Any:
        return by_name.get(part["name"], part) if part.get("expression") == "variable" else part

    return rewritten(program, change)


def at_place(capability: Capability, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Return arguments with the place named by `at` replaced by its components.

    Explicit arguments override the place. Arguments of capabilities without places are unchanged.

    Raises:
        RobotError: KG823 unknown place.
    """
    if AT not in arguments or not takes_place(capability, AT):
        return dict(arguments)
    name = str(arguments[AT])
    if name not in places:
        hint = f"It is one of: {', '.join(places)}." if places else "Name a file that defines it (`--places`)."
        raise RobotError("KG823", f"no place is called `{name}`", hint=did_you_mean(name, places) or hint)
    components = {part: values.written(one) for part, one in places[name].parts().items() if isinstance(one, Written)}
    of_place = values.of_place(values.place(components))
    there = {
        one.name: values.for_parameter(one, of_place[one.name]) for one in capability.parameters if one.name in of_place
    }
    return there | {given: value for given, value in arguments.items() if given != AT}
