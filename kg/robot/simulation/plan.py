"""Plans of worlds: rooms, walls, objects and tags with their positions in metres, from `worlds/*.toml`."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Final, Literal

import msgspec

PLANS: Final = ("office", "drone", "arm")
"""The names of the worlds."""

_FOLDER: Final = Path(__file__).parent / "worlds"
_DOOR: Final = 1.1  # width of doors in metres: enough for a base of 0.2 m radius with its margin


class Place(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A place on the floor with a heading, which plans give in degrees; `up` metres above it, for drones."""

    x: float
    y: float
    heading: float = 0.0
    up: float = 0.0

    @property
    def angle(self) -> float:
        """The heading in radians."""
        return math.radians(self.heading)


class Room(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A rectangle of the floor with a name; `place` is the target for a robot sent there."""

    name: str
    x: float
    y: float
    width: float
    depth: float
    place: Place

    def holds(self, x: float, y: float) -> bool:
        """Return whether a point is in the room."""
        return self.x <= x <= self.x + self.width and self.y <= y <= self.y + self.depth


class Wall(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A straight wall along an axis; `doors` are the centres of openings, measured from its start."""

    x: float
    y: float
    to_x: float
    to_y: float
    doors: tuple[float, ...] = ()

    def pieces(self) -> list[tuple[float, float, float, float]]:
        """Return the parts between the doors, each as x, y, to x, to y."""
        length = math.hypot(self.to_x - self.x, self.to_y - self.y)
        edges = [0.0, *(at + side for at in sorted(self.doors) for side in (-_DOOR / 2, _DOOR / 2)), length]
        return [
            (*self._at(begin / length), *self._at(end / length))
            for begin, end in zip(edges[::2], edges[1::2], strict=True)
        ]

    def _at(self, share: float) -> tuple[float, float]:
        return self.x + share * (self.to_x - self.x), self.y + share * (self.to_y - self.y)


class Thing(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An object on the floor; a cylinder has a radius instead of width and depth. An object with a mass in kg moves."""

    name: str
    shape: Literal["box", "cylinder"]
    x: float
    y: float
    height: float
    color: str
    width: float = 0.0
    depth: float = 0.0
    radius: float = 0.0
    mass: float = 0.0


class TagPlace(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The position of a tag's centre, and its heading in degrees; None for one that lies face up."""

    id: int
    x: float
    y: float
    z: float
    heading: float | None = None


class Plan(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A world: its size from the origin, and its content; `height` is that of the walls."""

    name: str
    robot: Literal["wheeled", "drone", "arm"]
    width: float
    depth: float
    height: float
    start: Place
    rooms: tuple[Room, ...]
    walls: tuple[Wall, ...]
    things: tuple[Thing, ...]
    tags: tuple[TagPlace, ...]

    def places(self) -> str:
        """Return the places of the rooms as the text of a file of places (docs/programs.md)."""

        def height(place: Place) -> str:
            return f", z = {place.up}" if place.up else ""

        return "".join(
            f"{json.dumps(one.name)} = {{ x = {one.place.x}, y = {one.place.y}{height(one.place)},"
            f" heading = {one.place.heading} }}\n"
            for one in self.rooms
        )

    def room_at(self, x: float, y: float) -> str | None:
        """Return the name of the smallest room that contains a point."""
        inside = [one for one in self.rooms if one.holds(x, y)]
        return min(inside, key=lambda one: one.width * one.depth).name if inside else None


def read_plan(name: str) -> Plan:
    """Return the plan of a world by its name, one of `PLANS`."""
    return msgspec.toml.decode((_FOLDER / f"{name}.toml").read_bytes(), type=Plan)
