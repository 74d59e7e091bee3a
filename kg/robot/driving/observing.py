"""What becomes of a movement: whether the robot moves at all, and whether others drive it, too."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connection import GraphProblem

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kg.robot.clock import Clock
    from kg.robot.connection import ComputationGraph
    from kg.robot.driving.newest import NewestMessages
    from kg.robot.driving.routes import Route

__all__ = ["MEASURED", "Observation", "other_controllers"]

MEASURED: Final = "sensingVelocity"
"""The capability whose parameters measure what the parameters of the same names command."""
_BEGINS: Final = 0.5
"""Seconds of the robot's time that a robot may take to begin to move."""
_SLOWEST: Final = 0.05
"""The part of a commanded speed that counts as moving."""
_ENOUGH: Final = 2
"""So many measurements without a speed show that a robot does not move."""
_UNNAMED: Final = "/_participant_"
"""What names of nodes begin with that DDS has found and that have not told their names yet, as our own watchdog."""


class Observation:
    """Compares the speeds that a robot was told with those that it measures, while `watch` runs."""

    def __init__(self, commanded: Mapping[str, Any]) -> None:
        self._commanded = {name: value for name, value in commanded.items() if isinstance(value, float) and value}
        self._still = 0
        self._moved = False

    @property
    def moved(self) -> bool | None:
        """Whether the robot moved; None when too little was measured."""
        return True if self._moved else False if self._still >= _ENOUGH else None

    async def watch(self, measuring: Route, newest: NewestMessages, clock: Clock) -> None:
        """Follow what the robot measures until it moves; a measurement that cannot be read tells nothing."""
        begun = clock.now()
        with suppress(RobotError):
            following = await newest.of(measuring.way.name, measuring.way.type)
            while not self._moved and not following.ended:
                await following.news()
                if following.newest is not None and clock.now() >= begun + _BEGINS:
                    self.take(measuring.values(following.newest.value))

    def take(self, measured: Mapping[str, Any]) -> None:
        """Take a measurement."""
        speeds = [(self._commanded[name], measured[name]) for name in self._commanded if measured.get(name) is not None]
        if any(abs(speed) >= _SLOWEST * abs(told) for told, speed in speeds):
            self._moved = True
        elif speeds:
            self._still += 1


def other_controllers(topic: str, graph: ComputationGraph) -> Iterator[GraphProblem]:
    """Yield a problem KG829 for each other node that publishes to a topic that moves a robot."""
    dead = {one.name for one in graph.nodes if one.problem is not None}
    for end in graph.ends:
        publishes = (end.name, end.role) == (topic, Role.PUBLISHES)
        if publishes and end.node not in dead and not end.node.startswith(_UNNAMED):
            yield GraphProblem("KG829", end.node, f"it publishes to `{topic}`, too")
