"""A quadrotor: a rigid body with four rotors in pybullet, and its velocity controller."""

from __future__ import annotations

import math
from enum import IntEnum
from typing import TYPE_CHECKING, Any, Final

from kg.robot.simulation.robots import Battery, Command, Pose
from kg.robot.simulation.scene import Camera, Scene, Vector

if TYPE_CHECKING:
    import numpy as np

    from kg.robot.simulation.plan import Place

SPEED: Final = 1.0
TURN: Final = 1.5

_MASS: Final = 0.42
_RADIUS: Final = 0.25
_HEIGHT: Final = 0.1
_ARM: Final = 0.18
_GRAVITY: Final = 9.81
_HOVER: Final = 1.2
_CLIMB: Final = 0.7
_SINK: Final = 0.4
_GROUND: Final = 0.08
_PUSH: Final = 3.0
_INERTIA: Final = (0.0070, 0.0070, 0.0131)
_HOLD: Final = 1.2
_STILL: Final = 0.1  # A drone brakes to this speed before it chooses the place to hold


class State(IntEnum):
    """States of a drone, by the numbers of `ardrone_autonomy/Navdata`."""

    EMERGENCY = 0
    LANDED = 2
    FLYING = 3
    HOVERING = 4
    TAKING_OFF = 6
    LANDING = 8


class Drone:
    """The drone in a scene; `step` moves it. Without a command it holds its place.

    It starts on the ground, or hovering if the start is above it.
    """

    def __init__(self, scene: Scene, start: Place, chance: np.random.Generator) -> None:
        self.camera = Camera()
        self.battery = Battery(idle=0.0008, moving=0.0008)
        self.state = State.HOVERING if start.up else State.LANDED
        self.pose = Pose(start.x, start.y, start.angle, _HEIGHT / 2 + start.up)
        self.velocity: Vector = (0.0, 0.0, 0.0)
        self.rates: Vector = (0.0, 0.0, 0.0)
        self.tilt = (0.0, 0.0)
        self.rotors = (0.0, 0.0, 0.0, 0.0)
        self.bumped = False
        self._scene = scene
        self._chance = chance
        self._command = Command()
        place = (start.x, start.y, self.pose.z)
        self._hold: list[float | None] = [*place] if start.up else [None, None, None]
        self._body = scene.cylinder(_RADIUS, _HEIGHT, place, (0.9, 0.45, 0.1, 1.0), _MASS)
        scene.bullet.changeDynamics(self._body, -1, localInertiaDiagonal=_INERTIA, restitution=0)
        turned = scene.bullet.getQuaternionFromEuler((0, 0, start.angle))
        scene.bullet.resetBasePositionAndOrientation(self._body, place, turned)

    @property
    def altitude(self) -> float:
        """Height of its lowest point above the ground in metres."""
        return max(0.0, self.pose.z - _HEIGHT / 2)

    def command(self, command: Command) -> None:
        """Fly at a velocity for half a second, or until another command."""
        self._command = command.limited(SPEED, TURN)

    def take_off(self) -> None:
        """Rise to 1.2 m and hover; does nothing unless the drone is on the ground and ready."""
        if self.state is State.LANDED:
            self.state = State.TAKING_OFF
            self._hold = [self.pose.x, self.pose.y, None]

    def land(self) -> None:
        """Land at the current place and switch the rotors off."""
        if self.state in {State.TAKING_OFF, State.FLYING, State.HOVERING}:
            self.state = State.LANDING
            self._hold = [self.pose.x, self.pose.y, None]

    def reset(self) -> None:
        """Switch the rotors off at once; a second call makes the drone ready again."""
        self.state = State.LANDED if self.state is State.EMERGENCY else State.EMERGENCY

    def step(self, seconds: float, now: float) -> None:
        """Advance by a step of the scene's time."""
        self._proceed(now)
        if self.state in {State.EMERGENCY, State.LANDED}:
            self.rotors = (0.0, 0.0, 0.0, 0.0)
        else:
            self._fly(self._wanted(self._command.now(now)), self._command.now(now).turn)
        self._scene.bullet.stepSimulation()
        self._measure()
        self.battery.drain(seconds, sum(self.rotors) / (_MASS * _GRAVITY))

    def _proceed(self, now: float) -> None:
        if self.state is State.TAKING_OFF and self.altitude >= _HOVER - 0.05:
            self.state = State.HOVERING
            self._hold[2] = _HOVER + _HEIGHT / 2
        elif self.state is State.LANDING and self.pose.z <= _GROUND:
            self.state = State.LANDED
        elif self.state in {State.FLYING, State.HOVERING}:
            still = self._command.now(now) == Command() or not any(self._axes(self._command))
            self.state = State.HOVERING if still else State.FLYING

    def _axes(self, command: Command) -> Vector:
        """Return the velocity of a command in the world frame."""
        cosine, sine = math.cos(self.pose.heading), math.sin(self.pose.heading)
        x = command.forward * cosine - command.left * sine
        return x, command.forward * sine + command.left * cosine, command.up

    def _wanted(self, command: Command) -> Vector:
        """Return the target velocity in the world frame: the command's, or back to the place to hold."""
        if self.state is State.TAKING_OFF:
            return self._hold_velocity(0), self._hold_velocity(1), _CLIMB
        if self.state is State.LANDING:
            return self._hold_velocity(0), self._hold_velocity(1), -_SINK
        wanted = self._axes(command)
        level = wanted[:2] == (0.0, 0.0)
        x, y, z = (
            self._along(axis, wanted[axis], free=free) for axis, free in enumerate((level, level, not wanted[2]))
        )
        return x, y, z if self.pose.z > _HOVER / 3 or z > 0 else 0.0

    def _along(self, axis: int, wanted: float, *, free: bool) -> float:
        if not free:
            self._hold[axis] = None
        elif self._hold[axis] is None and abs(self.velocity[axis]) < _STILL:
            self._hold[axis] = self._position()[axis]
        return self._hold_velocity(axis) if free else wanted

    def _hold_velocity(self, axis: int) -> float:
        target = self._hold[axis]
        off = 0.0 if target is None else target - self._position()[axis]
        return max(-SPEED, min(SPEED, _HOLD * off))

    def _position(self) -> Vector:
        return self.pose.x, self.pose.y, self.pose.z

    def _fly(self, wanted: Vector, turn: float) -> None:
        """Set the rotors: from velocity to tilt, and from tilt to torques (a cascade of P and PD controllers)."""
        push = [max(-_PUSH, min(_PUSH, 2.5 * (to - now))) for to, now in zip(wanted, self.velocity, strict=True)]
        cosine, sine = math.cos(self.pose.heading), math.sin(self.pose.heading)
        pitch = math.atan2(push[0] * cosine + push[1] * sine, _GRAVITY)
        roll = math.atan2(push[0] * sine - push[1] * cosine, _GRAVITY)
        lift = _MASS * (_GRAVITY + push[2]) / max(0.5, math.cos(self.tilt[0]) * math.cos(self.tilt[1]))
        around = [
            inertia * (90 * (to - now) - 16 * rate)
            for inertia, to, now, rate in zip(_INERTIA, (roll, pitch), self.tilt, self.rates, strict=False)
        ]
        corners = ((1, 1), (1, -1), (-1, -1), (-1, 1))
        self.rotors = tuple(  # type: ignore[assignment] # four corners make four rotors
            max(0.0, lift / 4 + (around[0] * y - around[1] * x) / (4 * _ARM)) for x, y in corners
        )
        bullet: Any = self._scene.bullet
        for force, (x, y) in zip(self.rotors, corners, strict=True):
            bullet.applyExternalForce(self._body, -1, (0, 0, force), (x * _ARM, y * _ARM, 0), bullet.LINK_FRAME)
        bullet.applyExternalTorque(self._body, -1, (0, 0, _INERTIA[2] * 8 * (turn - self.rates[2])), bullet.WORLD_FRAME)

    def _measure(self) -> None:
        bullet = self._scene.bullet
        (x, y, z), turned = bullet.getBasePositionAndOrientation(self._body)
        roll, pitch, heading = bullet.getEulerFromQuaternion(turned)
        self.velocity, spin = bullet.getBaseVelocity(self._body)
        self.pose = Pose(x, y, heading, z)
        self.tilt = (roll, pitch)
        cosine, sine = math.cos(heading), math.sin(heading)
        self.rates = (spin[0] * cosine + spin[1] * sine, spin[1] * cosine - spin[0] * sine, spin[2])
        floor = self._scene.floor
        self.bumped = any(touch[2] != floor for touch in bullet.getContactPoints(self._body))

    def located(self) -> Pose:
        """Return the pose by odometry, with an error of a few centimetres."""
        x, y = (float(one) for one in self._chance.normal(0.0, 0.02, 2))
        return Pose(self.pose.x + x, self.pose.y + y, self.pose.heading, self.pose.z)

    def picture(self, *, down: bool) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
        """Return the image of the forward camera, or of the downward one with forward on top."""
        ahead = (math.cos(self.pose.heading), math.sin(self.pose.heading), 0.0)
        reach = 0.0 if down else _RADIUS + 0.02
        eye = (self.pose.x + reach * ahead[0], self.pose.y + reach * ahead[1], self.pose.z - down * _HEIGHT)
        if down:
            return self._scene.picture(self.camera, eye, (eye[0], eye[1], eye[2] - 1), ahead)
        return self._scene.picture(self.camera, eye, (eye[0] + ahead[0], eye[1] + ahead[1], eye[2]), (0, 0, 1))
