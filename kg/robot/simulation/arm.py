"""An arm with a gripper, pybullet's Franka Panda: its hand follows a target, or its joints a trajectory."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.robots import Pose
from kg.robot.simulation.scene import Camera, Scene, Vector

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

    from kg.robot.simulation.plan import Place

JOINTS: Final = tuple(f"panda_joint{index}" for index in range(1, 8))
"""The names of the joints, from the base to the hand."""
WIDEST: Final = 0.08
"""Maximum opening of the gripper in metres."""

Quaternion = tuple[float, float, float, float]

_MODEL: Final = "franka_panda/panda.urdf"
_FINGERS: Final = (9, 10)
_HAND: Final = 11  # the point between the tips of the fingers
_HOME: Final = (0.0, -0.4, 0.0, -2.2, 0.0, 1.8, 0.785)
_LOWEST: Final = (-2.9, -1.76, -2.9, -3.07, -2.9, -0.02, -2.9)
_HIGHEST: Final = (2.9, 1.76, 2.9, -0.07, 2.9, 3.75, 2.9)
_FORCES: Final = (87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0)
_QUICKEST: Final = 2.0  # maximum speed of a joint in rad/s
_DOWN: Final[Quaternion] = (1.0, 0.0, 0.0, 0.0)
_SPEED: Final = 0.25
_TURNING: Final = 1.0
_SHOULDER: Final = 0.333
_REACH: Final = 0.75
"""Maximum distance of the hand from the shoulder in metres, pointing down; targets beyond are moved to this sphere."""
_LOWEST_HAND: Final = 0.01  # minimum height of the hand above the table in metres
_GRIP: Final = 40.0  # default force of the gripper in newtons
_CLOSING: Final = 0.1
_SUBSTEPS: Final = 4
_FRICTION: Final = 1.2
_CAMERA_AT: Final = 1.4


@dataclass(frozen=True, slots=True)
class Waypoint:
    """Positions of joints in rad, in the order of `JOINTS`, at a time of the world in seconds."""

    time: float
    positions: tuple[float, ...]


class Arm:
    """The arm on a table; `step` moves it. `pose` is that of the hand, its height above the table as `z`."""

    def __init__(self, scene: Scene, start: Place, _chance: np.random.Generator) -> None:
        self.camera = Camera()
        self.base = start
        self._scene = scene
        self._body = scene.model(_MODEL, (start.x, start.y, 0.0), start.angle)
        bullet = scene.bullet
        bullet.setPhysicsEngineParameter(numSubSteps=_SUBSTEPS, numSolverIterations=100)
        for finger in _FINGERS:
            bullet.changeDynamics(self._body, finger, lateralFriction=_FRICTION)
            bullet.resetJointState(self._body, finger, WIDEST / 2)
        for joint, position in enumerate(_HOME):
            bullet.resetJointState(self._body, joint, position)
        self._wanted = list(_HOME)
        self._wide, self._force = WIDEST, _GRIP
        self._way: list[Waypoint] = []
        self._begun = Waypoint(0.0, _HOME)
        self._aim = self._hand()
        self._target: tuple[Vector, Quaternion] | None = None
        self._time = 0.0
        self._measure()

    def reach(self, at: Vector, turned: Quaternion) -> None:
        """Move the hand straight to a position in metres and an orientation; a zero orientation points down."""
        if not all(math.isfinite(one) for one in (*at, *turned)):
            return
        length = math.hypot(*turned)
        x, y, z, w = (one / length for one in turned) if length else _DOWN
        shoulder = (self.base.x, self.base.y, _SHOULDER)
        above = (at[0], at[1], max(_LOWEST_HAND, at[2]))
        far = math.dist(above, shoulder)
        share = min(1.0, _REACH / far) if far else 0.0
        east, north, up = (middle + share * (to - middle) for to, middle in zip(above, shoulder, strict=True))
        self._way = []
        self._target, self._aim = ((east, north, up), (x, y, z, w)), self._hand()

    def follow(self, way: Sequence[Waypoint]) -> None:
        """Move the joints along a trajectory, whose times are later than now, within the joints' limits."""
        self._target = None
        self._begun = Waypoint(self._time, self.positions)
        self._way = list(way)

    def hold(self) -> None:
        """Hold the current position."""
        self._way, self._target, self._wanted = [], None, list(self.positions)

    def grip(self, wide: float, force: float) -> None:
        """Move the fingers to an opening in metres with a force in newtons, 0 for the default."""
        self._wide = max(0.0, min(WIDEST, wide)) if math.isfinite(wide) else self._wide
        self._force = min(force, _GRIP) if force > 0 else _GRIP

    def step(self, seconds: float, now: float) -> None:
        """Advance by a step of the scene's time."""
        self._time = now
        if self._way:
            self._proceed(now)
        elif self._target is not None:
            self._approach(*self._target, seconds)
        bullet = self._scene.bullet
        for joint, (to, force) in enumerate(zip(self._wanted, _FORCES, strict=True)):
            bullet.setJointMotorControl2(
                self._body, joint, bullet.POSITION_CONTROL, to, force=force, maxVelocity=_QUICKEST
            )
        for finger in _FINGERS:
            bullet.setJointMotorControl2(
                self._body, finger, bullet.POSITION_CONTROL, self._wide / 2, force=self._force, maxVelocity=_CLOSING
            )
        bullet.stepSimulation()
        self._measure()

    def _proceed(self, now: float) -> None:
        while self._way and self._way[0].time <= now:
            self._begun = self._way.pop(0)
        self._wanted = list(self._begun.positions)
        if self._way:
            to = self._way[0]
            share = (now - self._begun.time) / (to.time - self._begun.time)
            self._wanted = [one + share * (two - one) for one, two in zip(self._wanted, to.positions, strict=True)]

    def _approach(self, at: Vector, turned: Quaternion, seconds: float) -> None:
        """Set the joints for the next step of the hand towards its target, on a straight line."""
        aim, now = self._aim
        far = math.dist(at, aim)
        share = min(1.0, _SPEED * seconds / far) if far else 1.0
        x, y, z = (one + share * (two - one) for one, two in zip(aim, at, strict=True))
        bullet = self._scene.bullet
        # The angle between two orientations; a quaternion and its negative are the same one.
        angle = 2 * math.acos(min(1.0, abs(sum(one * two for one, two in zip(now, turned, strict=True)))))
        turn = min(1.0, _TURNING * seconds / angle) if angle else 1.0
        self._aim = (x, y, z), tuple(bullet.getQuaternionSlerp(now, turned, turn))
        self._wanted = list(
            bullet.calculateInverseKinematics(
                self._body,
                _HAND,
                *self._aim,
                lowerLimits=_LOWEST,
                upperLimits=_HIGHEST,
                jointRanges=[high - low for low, high in zip(_LOWEST, _HIGHEST, strict=True)],
                restPoses=self.positions,
                maxNumIterations=50,
                residualThreshold=1e-4,
            )[: len(JOINTS)]
        )

    def _hand(self) -> tuple[Vector, Quaternion]:
        link = self._scene.bullet.getLinkState(self._body, _HAND, computeForwardKinematics=True)
        return tuple(link[4]), tuple(link[5])

    def _measure(self) -> None:
        states = self._scene.bullet.getJointStates(self._body, (*range(len(JOINTS)), *_FINGERS))
        self.positions = tuple(float(one[0]) for one in states[:-2])
        self.velocities = tuple(float(one[1]) for one in states[:-2])
        self.efforts = tuple(float(one[3]) for one in states[:-2])
        self.fingers = tuple(float(one[0]) for one in states[-2:])
        self.closing = max(abs(float(one[1])) for one in states[-2:])
        self.squeeze = sum(abs(float(one[3])) for one in states[-2:]) / 2
        (x, y, z), self.turned = self._hand()
        heading = self._scene.bullet.getEulerFromQuaternion(self.turned)[2]
        self.pose = Pose(x, y, heading, z)

    @property
    def opening(self) -> float:
        """Distance of the fingers in metres."""
        return sum(self.fingers)

    def picture(self) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
        """Return the image of the camera, which looks down on the table."""
        x, y = self.base.x + 0.45, self.base.y
        return self._scene.picture(self.camera, (x, y, _CAMERA_AT), (x, y, 0.0), (0, 1, 0))
