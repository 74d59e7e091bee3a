"""What is sent where to do something, and how it ended."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from kg.errors import RobotError
from kg.robot.connection import Value  # noqa: TC001 - read when the classes are made

__all__ = ["Outcome", "Plan"]


class Plan(msgspec.Struct, frozen=True, kw_only=True):
    """What would be sent: the whole message (request, goal), where to, and for how long.

    `rate` is how often a second it is renewed, for `seconds` (None: until something else ends it); `afterwards` is the
    command that ends a movement. Both are absent where a message is sent once.
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
    """How a command ended.

    `ended` is `done`, `taken over` (by a later command on the same channel), `stopped` (by `Driver.stop`), or `planned`
    for a dry run. `values` is what a service answered or an action gave as its result: by parameter, as it is where no
    parameter is known. `sent` counts the messages, without the one that ends a movement. `moved` tells whether the
    robot measured a speed while it was told one; None where that is not known.
    """

    plan: Plan
    ended: Literal["done", "taken over", "stopped", "planned"]
    values: dict[str, Any] = {}
    sent: int = 0
    moved: bool | None = None

    @property
    def problem(self) -> RobotError | None:
        """The error KG820 when the robot was told to move and did not."""
        if self.moved is not False:
            return None
        told = f"{self.sent} messages were sent to `{self.plan.name}`, but the robot measured no speed: it did not move"
        return RobotError("KG820", told)
