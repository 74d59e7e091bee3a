"""Capabilities with their parameters and interfaces, as user interfaces and programs see them."""

from __future__ import annotations

from typing import Final, Literal

import msgspec

from kg.facts import Role
from kg.similar import folded

_SERVED_BY: Final = {"service": Role.SERVICES, "action": Role.ACTION_SERVERS}


class Parameter(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """An input (`write`) or output (`read`) of a capability, under a name that people understand.

    `unit` is a unit of `kg.robot.programs.units` (`m`, `m/s`, `rad`, ...) or None for a plain number or text. An
    `optional` one is missing in some messages, so only a known robot can require it.
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
    optional: bool = False


class Way(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """An interface of a capability: an end of a node of the system.

    `fields` are the paths of message fields by the names of parameters (`{"forward": "linear.x"}`), relative to the
    message of the topic, the request or response of the service, the goal or feedback or result of the action. `[]`
    applies the rest of a path to each element of a list (`markers[].id`), and paths may have functions of
    `kg.robot.driving.paths` (`yaw(pose.pose.orientation)`, `minimum(ranges)`). `constants` are fields with fixed values
    (`{"header.frame_id": "map"}`). `rate` is the number of times per second that a command has to be repeated, 0 for
    never.
    """

    kind: Literal["topic", "service", "action"]
    name: str
    type: str
    node: str
    fields: dict[str, str] = {}
    constants: dict[str, float | bool | str] = {}
    rate: float = 0

    @property
    def sent(self) -> str:
        """The type of the message, request or goal by which it is used."""
        return self.type + {"topic": "", "service": "_Request", "action": "_Goal"}[self.kind]


class Capability(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A capability of a system or a package.

    `name` is the local name of the IRI (`drivingAtVelocity`), used in programs and commands. `kinds` are the labels of
    its classes from the most general (Sensing, Movement, RobotKnowledge) to its own. A capability without interfaces is
    a general one that others imply. `moves` is the part of the robot that it moves: only one such capability at a time
    may move a part. `unavailable` is the reason why it cannot be used now: all its nodes are inactive
    (`kg.robot.lifecycle`).
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
    """The capabilities of a system, sorted by kind and label; `of` names the system, the package or the address."""

    of: str
    capabilities: tuple[Capability, ...] = ()


def called(capabilities: Capabilities, name: str) -> list[Capability]:
    """Return the capabilities of a name or IRI, or if there are none, of a label or alternative label, in any case."""
    wanted = folded(name)
    named = [one for one in capabilities.capabilities if wanted in {folded(one.name), folded(one.iri)}]
    return named or [
        one for one in capabilities.capabilities if wanted in {folded(each) for each in (one.label, *one.alternatives)}
    ]


def role_of(way: Way, *, reads: bool) -> Role:
    """Return the role of the nodes that an interface leads to."""
    return _SERVED_BY.get(way.kind, Role.PUBLISHES if reads else Role.SUBSCRIBES)
