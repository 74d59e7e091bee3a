"""What a robot can do, as faces and programs see it: capabilities with their parameters and the ways to reach them."""

from __future__ import annotations

from typing import Final, Literal

import msgspec

from kg.facts import Role

_SERVED_BY: Final = {"service": Role.SERVICES, "action": Role.ACTION_SERVERS}


class Parameter(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Something that a capability is given (`write`) or gives (`read`), under a name that people understand.

    `unit` is a unit of `kg.robot.programs.units` (`m`, `m/s`, `rad`, ...) or None for a plain number or text.
    """

    name: str
    label: str
    comment: str = ""
    type: Literal["number", "integer", "boolean", "text", "list"] = "number"
    unit: str | None = None
    default: float | bool | str | None = None
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()


class Way(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One way to reach a capability: an end of a node of the system.

    `fields` are the paths of message fields by the names of parameters (`{"forward": "linear.x"}`), relative to the
    message of the topic, the request or response of the service, the goal or feedback or result of the action; a list's
    field is taken for each element by `[]` (`markers[].id`), and a function of `kg.robot.driving.paths` stands
    before a path (`yaw(pose.pose.orientation)`, `minimum(ranges)`). `constants` are values of fields that are always
    the same (`{"header.frame_id": "map"}`). `rate` is how often a second a command has to be renewed, 0 for never.
    """

    kind: Literal["topic", "service", "action"]
    name: str
    type: str
    node: str
    fields: dict[str, str] = {}
    constants: dict[str, float | bool | str] = {}
    rate: float = 0


class Capability(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A capability that a system, or a package, has.

    `name` is the local name of the IRI (`drivingAtVelocity`): what programs and commands call it by. `kinds` are the
    labels of its classes from the most general (Sensing, Movement, RobotKnowledge) to its own. A capability without
    ways is a general one that others imply. `moves` is the part of the robot that is moved for as long as it is done:
    of what moves the same part one is done at a time. `unavailable` says why it cannot be read or done now, although
    the robot has it: all its nodes are inactive (`kg.robot.lifecycle`).
    """

    iri: str
    name: str
    label: str
    comment: str = ""
    alternatives: tuple[str, ...] = ()
    kinds: tuple[str, ...] = ()
    modality: Literal["read", "write"]
    parameters: tuple[Parameter, ...] = ()
    ways: tuple[Way, ...] = ()
    implied_by: tuple[str, ...] = ()
    moves: str | None = None
    unavailable: str | None = None


class Capabilities(msgspec.Struct, frozen=True, kw_only=True):
    """What a system can do, sorted by kind and label; `of` names the system, the package or the address."""

    of: str
    capabilities: tuple[Capability, ...] = ()


def role_of(way: Way, *, reads: bool) -> Role:
    """Return the role of the nodes that a way leads to."""
    return _SERVED_BY.get(way.kind, Role.PUBLISHES if reads else Role.SUBSCRIBES)
