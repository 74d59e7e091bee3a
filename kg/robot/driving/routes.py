"""Prepared interfaces of a capability: checked paths, conversion between messages and values, and plans."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from kg.errors import RobotError
from kg.robot.clock import stamp
from kg.robot.connection import Value  # noqa: TC001 - read when the classes are made
from kg.robot.driving.arguments import missing
from kg.robot.driving.paths import Path, look, parse, put, roots, type_at

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capability, Way
    from kg.robot.messages import Types


class Plan(msgspec.Struct, frozen=True, kw_only=True):
    """A message (request, goal) to send, its target, and its duration.

    `rate` is the number of repetitions per second, for `seconds` (None: until something else ends it). `afterwards` is
    the command that ends a movement. Both are absent for a message that is sent once.
    """

    capability: str
    kind: Literal["topic", "service", "action"]
    name: str
    type: str
    node: str
    message: Value
    rate: float = 0
    seconds: float | None = None
    afterwards: Value | None = None


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """The result of a command.

    `ended` is `done`, `taken over` (by a later command on the same channel), `stopped` (by `Driver.stop`), or `planned`
    for a dry run. `values` is the response of a service or the result of an action, by parameter, or unchanged if no
    parameter is known. `sent` counts the messages, without the one that ends a movement. `moved` is whether the robot
    measured a speed when one was commanded; None if unknown.
    """

    plan: Plan
    ended: Literal["done", "taken over", "stopped", "planned"]
    values: dict[str, Any] = {}
    sent: int = 0
    moved: bool | None = None

    @property
    def problem(self) -> RobotError | None:
        """The error KG820 if the robot was commanded to move and did not."""
        if self.moved is not False:
            return None
        message = (
            f"{self.sent} messages were sent to `{self.plan.name}`, but the robot measured no speed: it did not move"
        )
        return RobotError("KG820", message)


_TOLD: Final = {"topic": ("",), "service": ("_Response",), "action": ("_Feedback", "_Result")}


@dataclass(frozen=True, slots=True)
class Route:
    """An interface whose paths have been checked.

    `stamped` is whether the message has a header with a time. `arguments` are the paths of its fields by parameter,
    `constants` fields with fixed values, and `answers` the paths to read, by parameter, in order.
    """

    capability: Capability
    way: Way
    stamped: bool
    arguments: Mapping[str, Path]
    answers: Mapping[str, Path]
    constants: tuple[tuple[Path, Any], ...]

    @property
    def moves(self) -> bool:
        """Whether it is a movement: repeated, and ended by a zero command."""
        return self.way.kind == "topic" and self.way.rate > 0

    def message(self, values: Mapping[str, Any], now: float) -> Value:
        """Return the message with these values of parameters at a time in seconds.

        Raises:
            RobotError: KG823 a parameter without a value, or without a field in this message.
        """
        parameters = {one.name: one for one in self.capability.parameters}
        for name, value in values.items():
            if name not in self.arguments and value != parameters[name].default:
                raise RobotError("KG823", f"`{name}` cannot be given by {self.way.kind} `{self.way.name}`")
        for name in self.arguments:
            if name not in values:
                raise missing(parameters[name])
        return self._message({name: values[name] for name in self.arguments}, now)

    def zero(self, now: float) -> Value:
        """Return the message that ends a movement: all numbers zero."""
        parameters = {one.name: one for one in self.capability.parameters}
        still = {"number": 0.0, "integer": 0, "boolean": False}
        values = {name: still.get(parameters[name].type, parameters[name].default) for name in self.arguments}
        return self._message({name: value for name, value in values.items() if value is not None}, now)

    def _message(self, values: Mapping[str, Any], now: float) -> Value:
        message: Value = {}
        for path, value in self.constants:
            put(path, message, value)
        for name, value in values.items():
            put(self.arguments[name], message, value)
        if self.stamped:
            message.setdefault("header", {})
        return self.restamped(message, now)

    def restamped(self, message: Value, now: float) -> Value:
        """Return a message with the time in its header."""
        return {**message, "header": {**message["header"], "stamp": stamp(now)}} if self.stamped else message

    def values(self, message: Value) -> dict[str, Any]:
        """Return the values in a message by parameter; None for missing ones (NaN, the first of an empty list)."""
        return {name: look(path, message) for name, path in self.answers.items()}

    def answer(self, message: Value) -> dict[str, Any]:
        """Return the values in a response, feedback or result, by parameter, or unchanged if none is known.

        Raises:
            RobotError: KG808 the response reports that `success` is false.
        """
        if self.way.kind == "service" and message.get("success") is False:
            why = message.get("message") or message.get("status_message") or "no reason given"
            raise RobotError("KG808", f"`{self.way.name}` did not succeed: {why}")
        reported = {name: path for name, path in self.answers.items() if set(roots(path)) <= message.keys()}
        return {name: look(path, message) for name, path in reported.items()} or message


def route(capability: Capability, way: Way, types: Types) -> Route:
    """Prepare an interface; RobotError KG826 paths that do not fit the message, KG804 its type is unknown."""
    parts = [way.type + part for part in _TOLD[way.kind]]
    ordered = [one.name for one in capability.parameters if one.name in way.fields]
    paths = {name: parse(way.fields[name]) for name in ordered}
    own = {one.name for one in types.fields(way.sent)}
    if capability.modality == "write":
        arguments = {name: path for name, path in paths.items() if way.kind == "topic" or set(roots(path)) <= own}
    else:
        arguments = {}
    answers = {name: path for name, path in paths.items() if name not in arguments}
    constants = tuple((parse(path), value) for path, value in way.constants.items())
    for path in [*arguments.values(), *(path for path, _ in constants)]:
        type_at(path, types, way.sent)  # raises if it does not fit
    for path in answers.values():
        fitting = [kind for kind in parts if set(roots(path)) <= {one.name for one in types.fields(kind)}]
        type_at(path, types, (fitting or parts)[0])
    stamped = way.kind == "topic" and any(one.type == "std_msgs/Header" for one in types.fields(way.sent)[:1])
    return Route(capability, way, stamped, arguments, answers, constants)
