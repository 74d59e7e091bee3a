"""Processor time by stage: functions that begin one are wrapped."""

from __future__ import annotations

import time
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Clock", "Stages"]

Stages: TypeAlias = "dict[str, list[tuple[Any, str]]]"
"""For each stage the functions that begin it: a module or class, and the name in it."""


class Clock:
    """Processor seconds by stage; a stage stops while one inside of it runs."""

    def __init__(self, stages: Stages) -> None:
        self.seconds = dict.fromkeys([*stages, "rest"], 0.0)
        self._stages = stages
        self._stage = "rest"
        self._since = time.process_time()

    def attach(self) -> None:
        """Charge the functions of each stage to it from now on."""
        for stage, functions in self._stages.items():
            for holder, name in functions:
                setattr(holder, name, self.timed(stage, getattr(holder, name)))

    def begin(self) -> None:
        """Forget what was charged to the rest by now."""
        self.enter("rest")
        self.seconds["rest"] = 0.0

    def enter(self, stage: str) -> str:
        """Begin a stage; return the one that ran."""
        now = time.process_time()
        self.seconds[self._stage] += now - self._since
        before, self._stage, self._since = self._stage, stage, now
        return before

    def timed(self, stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function that is charged to a stage."""

        @wraps(function)
        def run(*arguments: object, **named: object) -> object:
            if self._stage == stage:
                return function(*arguments, **named)
            before = self.enter(stage)
            try:
                return function(*arguments, **named)
            finally:
                self.enter(before)

        return run
