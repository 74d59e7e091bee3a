"""What becomes of a movement: whether the robot moves at all, and whether others drive it, too."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connection import GraphProblem
from kg.robot.driving.watchdog import NODES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kg.robot.clock import Clock
    from kg.robot.connection import ComputationGraph
    from kg.robot.driving.newest import NewestMessages
    from kg.robot.driving.routes import Route

__all__ = ["MEASURED", "Observation", "other_controllers"]

_VELOCITY: Final = "sensingVelocity"
"""The capability whose parameters measure what the parameters of the same names command."""
MEASURED: Final = frozenset({_VELOCITY, "sensingPose"})
"""The capabilities that show whether a robot moves."""
_BEGINS: Final = 0.5
"""Seconds of the robot's time that a robot may take to begin to move."""
_SLOWEST: Final = 0.1
"""The part of a commanded speed that counts as moving: what stands on smooth ground may slide."""
_NOISE: Final = 0.15
"""Metres, or radians, by which the measured place of a robot that stands still may vary."""
_ENOUGH: Final = 2
"""So many measurements without a speed show that a robot does not move."""
_NO_CONTROLLERS: Final = (NODES, "/_participant_")
"""What names of nodes begin with that are watchdogs, or that DDS has found and that have not told their names yet."""


class Observation:
    """Compares the speeds that a robot was told with those that it measures, while `watch` runs.

    A place that changes shows that it moves, too: not everyone who publishes odometry measures speeds.
    """

    def __init__(self, commanded: Mapping[str, Any]) -> None:
        self._commanded = {name: value for name, value in commanded.items() if isinstance(value, float) and value}
        self._first: dict[str, Any] | None = None
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
                if following.newest is None:
                    continue
                measured = measuring.values(following.newest.value)
                seconds = clock.now() - begun
                way = seconds * max(map(abs, self._commanded.values()), default=0.0)
                if measuring.capability.name != _VELOCITY:
                    self._take_place(measured, way)
                elif seconds >= _BEGINS and way >= 2 * _NOISE:
                    self._take_speeds(measured)

    def _take_place(self, measured: dict[str, Any], way: float) -> None:
        """Compare a place with the first: its axes need not be those of the commands."""
        self._first = self._first or measured
        pairs = [(self._first[name], measured[name]) for name in measured]
        least = max(_NOISE, _SLOWEST * way)
        self._moved |= any(None not in pair and abs(pair[0] - pair[1]) >= least for pair in pairs)

    def _take_speeds(self, measured: Mapping[str, Any]) -> None:
        speeds = [(self._commanded[name], measured[name]) for name in self._commanded if measured.get(name) is not None]
        if any(abs(speed) >= _SLOWEST * abs(told) for told, speed in speeds):
            self._moved = True
        elif speeds:
            self._still += 1


def other_controllers(topic: str, graph: ComputationGraph) -> Iterator[GraphProblem]:
    """Yield a problem KG829 for each other node that publishes to a topic that moves a robot.

    A node that carries out goals, as navigation does, publishes while it has one, and is not a controller of its own.
    """
    left_out = {one.name for one in graph.nodes if one.problem is not None}
    left_out |= {one.node for one in graph.ends if one.role is Role.ACTION_SERVERS}
    for end in graph.ends:
        publishes = (end.name, end.role) == (topic, Role.PUBLISHES)
        if publishes and end.node not in left_out and not end.node.startswith(_NO_CONTROLLERS):
            yield GraphProblem("KG829", end.node, f"it publishes to `{topic}`, too")
