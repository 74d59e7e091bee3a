"""A differential-drive robot: a round base with collisions by pybullet, a laser, odometry, a camera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.robots import Battery, Command, Pose, approached, wrapped
from kg.robot.simulation.scene import Camera, Scene, Vector

if TYPE_CHECKING:
    import numpy as np

    from kg.robot.simulation.plan import Place

RADIUS: Final = 0.2
SPEED: Final = 0.8
TURN: Final = 2.0
RAYS: Final = 120
"""Number of the laser's rays, from the rear counterclockwise."""
LASER_RANGE: Final = 8.0
_LASER_NEAR: Final = 0.21

_MASS: Final = 6.0
_HEIGHT: Final = 0.34
_LIFT: Final = 0.2
_LASER_AT: Final = 0.3
_CAMERA_AT: Final = 0.5
_QUICKER: Final = 1.5
_QUICKER_TURN: Final = 4.0
_SLIP: Final = 0.01
_LASER_NOISE: Final = 0.005


class Wheeled:
    """The robot in a scene; `step` moves it. Its odometry drifts by wheel slip, with a seed."""

    def __init__(self, scene: Scene, start: Place, chance: np.random.Generator) -> None:
        self.camera = Camera()
        self.battery = Battery(idle=0.0004, moving=0.0012)
        self.pose = Pose(start.x, start.y, start.angle)
        self.odometry = Pose(0.0, 0.0, 0.0)
        self.forward = 0.0
        self.turn = 0.0
        self.bumped = False
        self._scene = scene
        self._chance = chance
        self._command = Command()
        self._body = scene.cylinder(RADIUS, _HEIGHT, (start.x, start.y, _LIFT), (0.2, 0.25, 0.3, 1.0), _MASS)
        scene.bullet.changeDynamics(self._body, -1, lateralFriction=0, restitution=0, linearDamping=0, angularDamping=0)
        self._level()

    def command(self, command: Command) -> None:
        """Drive at a velocity for half a second, or until another command."""
        self._command = command.limited(SPEED, TURN)

    def step(self, seconds: float, now: float) -> None:
        """Advance by a step of the scene's time."""
        wanted = self._command.now(now)
        self.forward = approached(self.forward, wanted.forward, _QUICKER * seconds)
        self.turn = approached(self.turn, wanted.turn, _QUICKER_TURN * seconds)
        if self._blocked():
            self.forward = 0.0
        heading = self.pose.heading + self.turn * seconds / 2
        across = (self.forward * math.cos(heading), self.forward * math.sin(heading), 0.0)
        self._scene.bullet.resetBaseVelocity(self._body, across, (0, 0, self.turn))
        self._scene.bullet.stepSimulation()
        self._measure(seconds)
        self.battery.drain(seconds, abs(self.forward))

    def _blocked(self) -> bool:
        self.bumped = False
        ahead = math.copysign(1.0, self.forward)
        x, y = ahead * math.cos(self.pose.heading), ahead * math.sin(self.pose.heading)
        blocked = False
        for touch in self._scene.bullet.getContactPoints(self._body):
            self.bumped = True
            normal = touch[7]
            blocked = blocked or (self.forward != 0 and normal[0] * x + normal[1] * y < -0.3)  # noqa: PLR2004 - 17 deg
        return blocked

    def _measure(self, seconds: float) -> None:
        (x, y, _), turned = self._scene.bullet.getBasePositionAndOrientation(self._body)
        heading = self._scene.bullet.getEulerFromQuaternion(turned)[2]
        before, self.pose = self.pose, Pose(x, y, heading)
        self._level()
        ahead = (x - before.x) * math.cos(heading) + (y - before.y) * math.sin(heading)
        turn = wrapped(heading - before.heading)
        slip, twist = (1 + _SLIP * float(one) for one in self._chance.standard_normal(2))
        self.odometry = self.odometry.moved(ahead * slip, 0.0, turn * twist)
        self.forward = approached(self.forward, ahead / seconds, 1.0) if self.bumped else self.forward

    def _level(self) -> None:
        turned = self._scene.bullet.getQuaternionFromEuler((0, 0, self.pose.heading))
        self._scene.bullet.resetBasePositionAndOrientation(self._body, (self.pose.x, self.pose.y, _LIFT), turned)

    def scan(self) -> list[float]:
        """Return the ranges of the laser in metres, from the rear counterclockwise; infinite without an obstacle."""
        angles = [self.pose.heading - math.pi + index * math.tau / RAYS for index in range(RAYS)]
        ways = [(math.cos(one), math.sin(one)) for one in angles]
        free = self._scene.rays(
            [self._ray(*way, _LASER_NEAR) for way in ways], [self._ray(*way, LASER_RANGE) for way in ways]
        )
        noise = _LASER_NOISE * self._chance.standard_normal(RAYS)
        length = LASER_RANGE - _LASER_NEAR
        return [
            _LASER_NEAR + share * length + float(off) if share < 1 else math.inf
            for share, off in zip(free, noise, strict=True)
        ]

    def _ray(self, x: float, y: float, length: float) -> Vector:
        return self.pose.x + x * length, self.pose.y + y * length, _LASER_AT

    def located(self) -> Pose:
        """Return the pose by odometry, with an error of a few centimetres."""
        x, y, heading = (float(one) for one in self._chance.normal(0.0, (0.02, 0.02, 0.01)))
        return Pose(self.pose.x + x, self.pose.y + y, wrapped(self.pose.heading + heading))

    def picture(self) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
        """Return the image of the forward camera."""
        x, y = math.cos(self.pose.heading), math.sin(self.pose.heading)
        eye = (self.pose.x + x * RADIUS, self.pose.y + y * RADIUS, _CAMERA_AT)
        return self._scene.picture(self.camera, eye, (eye[0] + x, eye[1] + y, eye[2]), (0, 0, 1))
