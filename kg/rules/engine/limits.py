"""Limits of the time and size of a run."""

from __future__ import annotations

import time
from dataclasses import dataclass

from kg.errors import RuleError


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of the time and the triples of a run; None for unlimited.

    With either of them rules may make terms in recursion: the limit ends an infinite run.
    """

    deadline: float | None = None
    """Seconds."""
    max_triples: int | None = None
    """Inferred triples."""

    @property
    def bounded(self) -> bool:
        """Whether any limit is set."""
        return self.deadline is not None or self.max_triples is not None


class Clock:
    """Watches the limits of one run; has the name of the running rule for errors."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._end = None if limits.deadline is None else time.monotonic() + limits.deadline
        self.rule: object = ""
        self.round = 0

    @property
    def left(self) -> float | None:
        """Seconds to the time limit, None without one."""
        return None if self._end is None else max(self._end - time.monotonic(), 0.0)

    def check(self, inferred: int = 0) -> None:
        """Raise `RuleError` KG205 after the time limit or with more triples than allowed."""
        if self._end is not None and time.monotonic() > self._end:
            raise self._error(f"the deadline of {self._limits.deadline:g} s is over", "Raise the deadline")
        most = self._limits.max_triples
        if most is not None and inferred > most:
            raise self._error(f"more than {most:,} triples are inferred", "Raise the limit")

    def may_exceed(self, inferred: int) -> bool:
        """Return whether so many triples, some of them perhaps known already, are more than allowed."""
        return self._limits.max_triples is not None and inferred > self._limits.max_triples

    def _error(self, what: str, way: str) -> RuleError:
        message = f"{what}, at rule {self.rule}, round {self.round}; nothing was changed"
        return RuleError("KG205", message, hint=f"{way}, or make the rule more specific.")
