"""A world with its robot and its time, which advances in fixed steps; the ground truth of tests."""

from __future__ import annotations

import math
from typing import Final, Self

import numpy as np

from kg.robot.clock import SimulatedClock
from kg.robot.simulation.arm import Arm
from kg.robot.simulation.drone import Drone
from kg.robot.simulation.plan import Place, Plan, read_plan
from kg.robot.simulation.robots import Pose, Trail
from kg.robot.simulation.scene import Scene, Vector
from kg.robot.simulation.wheeled import Wheeled

_STEPS: Final = {"wheeled": 0.02, "drone": 0.01, "arm": 0.01}
_ROBOTS: Final[dict[str, type[Wheeled | Drone | Arm]]] = {"wheeled": Wheeled, "drone": Drone, "arm": Arm}
_LASTING: Final = 1.0
_RISE: Final = 0.3


class World:
    """A world by the name of its plan; the same seed gives the same noise.

    `visited` has the names of rooms in which the robot stayed for a second, in order, `turned` is the sum of its turns
    in radians, in either direction, and `rises` the number of times that it rose by 0.3 m or more. `clock` is the time
    of the world for the nodes in it. The robot starts at `start`, by default that of the plan.
    """

    def __init__(self, name: str, *, seed: int = 0, start: Place | None = None) -> None:
        """Raise RobotError KG840 if pybullet or OpenCV is not installed."""
        self.plan: Plan = read_plan(name)
        self.start = start or self.plan.start
        self.step = _STEPS[self.plan.robot]
        self.clock = SimulatedClock()
        self.trail = Trail()
        self.visited: list[str] = []
        self._entered: tuple[str | None, float] = (None, 0.0)
        self._steps = 0
        self._scene = Scene(self.plan, self.step, gravity=self.plan.robot != "wheeled")
        chance = np.random.default_rng(seed)
        self.robot: Wheeled | Drone | Arm = _ROBOTS[self.plan.robot](self._scene, self.start, chance)
        self.turned, self.rises = 0.0, 0
        self._heading, self._low, self._rising = self.robot.pose.heading, self.robot.pose.z, False

    @property
    def time(self) -> float:
        """The time of the world in seconds, from 0."""
        return round(self._steps * self.step, 6)

    def advance(self) -> None:
        """Advance by one step."""
        self._steps += 1
        self.robot.step(self.step, self.time)
        pose = self.robot.pose
        self.trail.add(pose)
        room, (before, since) = self.plan.room_at(pose.x, pose.y), self._entered
        if room != before:
            self._entered = (room, self.time)
        elif room and self.time - since >= _LASTING and self.visited[-1:] != [room]:
            self.visited.append(room)
        self._note_motion(pose)
        self.clock.set_time(self.time)

    def _note_motion(self, pose: Pose) -> None:
        self.turned += abs(math.remainder(pose.heading - self._heading, math.tau))
        self._heading = pose.heading
        if self._rising and pose.z < self._low - _RISE / 2:
            self._rising = False
        if self._rising:
            self._low = max(self._low, pose.z)  # the highest point of this rise
        else:
            self._low = min(self._low, pose.z)
            if pose.z >= self._low + _RISE:
                self.rises, self._rising, self._low = self.rises + 1, True, pose.z

    def thing_at(self, name: str) -> Vector:
        """Return the centre of an object of the plan in metres; `KeyError` for an unknown name."""
        return self._scene.thing_at(name)

    def close(self) -> None:
        """End the physics."""
        self._scene.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
