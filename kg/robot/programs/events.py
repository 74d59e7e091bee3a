"""What a program tells while it runs, and how it ended."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from kg.robot.programs.problems import Problem  # noqa: TC001 - read when the classes are made

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.capability import Capability, Parameter
    from kg.robot.clock import Clock
    from kg.robot.programs.tree import Statement
    from kg.robot.programs.values import Quantity

__all__ = ["Ended", "Events"]

_VALUES_EVERY: Final = 0.2
"""Seconds between two events that tell of one value."""


class Ended(msgspec.Struct, frozen=True, kw_only=True):
    """How a program ended: `done`, `stopped` by a statement, `failed` with a problem, or `cancelled`.

    `statements` counts those that were carried out, `seconds` is the time on the robot's clock.
    """

    ended: Literal["done", "stopped", "failed", "cancelled"]
    problem: Problem | None = None
    statements: int = 0
    seconds: float = 0.0


class Events:
    """Tells whoever looks on what happens, as plain dicts: `event`, `at` (seconds since the beginning), `id`, `path`.

    `enter`, `leave` of a statement; `value` that was read (`capability`, `parameter`, `value`, `unit`); `set` of a
    variable (`variable`, `value` in base units, `shown`); `log` (`message`); `feedback` of a goal (`capability`,
    `values`); `planned` in a dry run; `event` when a watched condition began to hold; `paused`, `resumed`; `error`
    (`code`, `message`, `hint`); `warning` (the same) of what goes on and may not do what was meant; and at the end one
    of `done`, `stopped`, `failed`, `cancelled` (`seconds`, `statements`).
    """

    def __init__(self, tell: Callable[[dict[str, Any]], None] | None, clock: Clock) -> None:
        """`tell` is called in the loop of the program and must return at once."""
        self._tell = tell
        self._clock = clock
        self._begun = clock.now()
        self._told: dict[tuple[str, str], tuple[float, Any]] = {}
        self.statements = 0

    @property
    def seconds(self) -> float:
        """Seconds on the robot's clock since the program began."""
        return max(self._clock.now() - self._begun, 0.0)

    def tell(self, event: str, path: str = "", statement: Statement | None = None, **more: Any) -> None:
        """Tell of something that happened at a statement, or to the program."""
        if self._tell is None:
            return
        identifier = None if statement is None else statement.id
        told: dict[str, Any] = {"event": event, "at": round(self.seconds, 3), "id": identifier}
        self._tell(told | ({"path": path} if path else {}) | more)

    def value(self, path: str, statement: Statement, capability: Capability, parameter: Parameter, value: Any) -> None:
        """Tell of a value that was read, if it is another one and the last was not told just now."""
        key = capability.name, parameter.name
        then, before = self._told.get(key, (float("-inf"), None))
        if value == before or self.seconds - then < _VALUES_EVERY:
            return
        self._told[key] = self.seconds, value
        unit = {"unit": parameter.unit} if parameter.unit else {}
        self.tell("value", path, statement, capability=capability.name, parameter=parameter.name, value=value, **unit)

    def variable(self, path: str, statement: Statement, name: str, quantity: Quantity, shown: str) -> None:
        """Tell of a variable that got a value."""
        self.tell("set", path, statement, variable=name, value=quantity.value, shown=shown)
