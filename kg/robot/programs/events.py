"""Problems and events of a program: what is wrong and where, what happens while it runs, and how it ended.

A problem is at a block, with line and column if the program is a text.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from kg.errors import Place, RobotError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.robot.capability import Capability, Parameter
    from kg.robot.clock import Clock
    from kg.robot.connection import Level
    from kg.robot.programs.tree import Statement


class Problem(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A problem of a program.

    `path` leads to the part of the tree (`/body/0/then/1/condition`), `id` identifies its statement. A program with an
    `error` is not run; with a `warning` it is.
    """

    id: str | None
    path: str
    message: str
    hint: str | None = None
    code: str = "KG836"
    severity: Literal["error", "warning"] = "error"

    @classmethod
    def of(cls, error: RobotError, path: str, identifier: str | None) -> Problem:
        """Return the problem for an error."""
        return cls(id=identifier, path=path, message=error.message, hint=error.hint, code=error.code)


def place_at(file: str, text: str | None, places: Mapping[str, tuple[int, int]], path: str) -> Place:
    """Return the place of a part of a program's tree: its line in the text, or that of the nearest part above it.

    A program without text (`text` is None) has the path instead of a line.
    """
    if text is None:
        return Place(f"{file}#{path}")
    above = path
    while above and above not in places:
        above = above.rpartition("/")[0]
    line, column = places.get(above, (1, 1))
    lines = text.split("\n")
    return Place(file, line, column, lines[line - 1] if line <= len(lines) else "")


_VALUES_EVERY: Final = 0.2  # minimum seconds between two events about one value


class Ended(msgspec.Struct, frozen=True, kw_only=True):
    """The result of a run: `done`, `stopped` by a statement, `failed` with a problem, or `cancelled`.

    `statements` counts the executed statements, `seconds` is the time on the robot's clock.
    """

    ended: Literal["done", "stopped", "failed", "cancelled"]
    problem: Problem | None = None
    statements: int = 0
    seconds: float = 0.0


class Events:
    """Emitter of events as plain dicts: `event`, `at` (seconds since the start), `id`, `path`.

    `enter`, `leave` of a statement; `value` that was read (`capability`, `parameter`, `value`, `unit`); `set` of a
    variable (`variable`, `value` in base units, `shown`); `log` (`message`); `feedback` of a goal (`capability`,
    `values`); `planned` in a dry run; `event` when a watched condition becomes true; `paused`, `resumed`; `error`
    (`code`, `message`, `hint`); `warning` (the same) for work that continues and might not have the intended effect;
    finally one of `done`, `stopped`, `failed`, `cancelled` (`seconds`, `statements`).
    """

    def __init__(
        self,
        send: Callable[[dict[str, Any]], None] | None,
        clock: Clock,
        log: Callable[[Level, str], None] = lambda _level, _message: None,
    ) -> None:
        """Create an emitter.

        `send` is called in the event loop of the program and must return at once. `log` receives messages and errors.
        """
        self._send = send
        self._log = log
        self._clock = clock
        self._begun = clock.now()
        self._last: dict[tuple[str, str], tuple[float, Any]] = {}

    @property
    def seconds(self) -> float:
        """Seconds on the robot's clock since the start of the program."""
        return max(self._clock.now() - self._begun, 0.0)

    def emit(self, event: str, path: str = "", statement: Statement | None = None, **more: Any) -> None:
        """Emit an event of a statement, or of the program."""
        if event == "log":
            self._log("info", more["message"])
        elif event == "error":
            self._log("error", f"[{more['code']}] {more['message']}")
        if self._send is None:
            return
        identifier = None if statement is None else statement.id
        emitted: dict[str, Any] = {"event": event, "at": round(self.seconds, 3), "id": identifier}
        self._send(emitted | ({"path": path} if path else {}) | more)

    def value(self, path: str, statement: Statement, capability: Capability, parameter: Parameter, value: Any) -> None:
        """Emit a value that was read, if it has changed and the last one was not emitted just now."""
        key = capability.name, parameter.name
        then, before = self._last.get(key, (float("-inf"), None))
        if value == before or self.seconds - then < _VALUES_EVERY:
            return
        self._last[key] = self.seconds, value
        unit = {"unit": parameter.unit} if parameter.unit else {}
        self.emit("value", path, statement, capability=capability.name, parameter=parameter.name, value=value, **unit)
