"""What is told of a program: what is wrong with it and where, what happens while it runs, and how it ended.

A problem is at a block, which has a line and column if the program is a text.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from kg.errors import Place, RobotError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.robot.capability import Capability, Parameter
    from kg.robot.clock import Clock
    from kg.robot.programs.tree import Statement
    from kg.robot.programs.values import Quantity


class Problem(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Something wrong with a program.

    `path` leads to the part of the tree (`/body/0/then/1/condition`), `id` is that of the statement it belongs to. A
    program with an `error` is not run; with a `warning` it is.
    """

    id: str | None
    path: str
    message: str
    hint: str | None = None
    code: str = "KG836"
    severity: Literal["error", "warning"] = "error"

    @classmethod
    def of(cls, error: RobotError, path: str, identifier: str | None) -> Problem:
        """Return the problem that an error is."""
        return cls(id=identifier, path=path, message=error.message, hint=error.hint, code=error.code)


def place_at(file: str, text: str | None, places: Mapping[str, tuple[int, int]], path: str) -> Place:
    """Return the place of a part of a program's tree: its line in the text, or of the nearest part above it.

    A program that is not text (`text` is None) has the path in place of a line.
    """
    if text is None:
        return Place(f"{file}#{path}")
    above = path
    while above and above not in places:
        above = above.rpartition("/")[0]
    line, column = places.get(above, (1, 1))
    lines = text.split("\n")
    return Place(file, line, column, lines[line - 1] if line <= len(lines) else "")


_VALUES_EVERY: Final = 0.2  # seconds between two events that tell of one value


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
