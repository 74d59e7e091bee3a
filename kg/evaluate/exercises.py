"""The exercises of the onto-ros paper (section 4.2), worded by us: programs, and whether the world says they worked.

They stand in `examples/programs/`; `exercises.toml` there says what each has to reach. What was reached is read off the
simulated world itself, not off what the robot believes.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import msgspec

from kg.errors import RobotError
from kg.resources import folder
from kg.robot.connecting import connect
from kg.robot.driving import Driver
from kg.robot.live import infer
from kg.robot.programs.check import check
from kg.robot.programs.files import load
from kg.robot.programs.places import placed, read_places
from kg.robot.programs.runner import Runner
from kg.robot.simulation.drone import Drone, State
from kg.robot.simulation.hosting import hosted_in_memory

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from kg.robot.capability import Capabilities
    from kg.robot.programs.tree import Program
    from kg.robot.simulation.world import World
    from kg.settings import Settings

__all__ = [
    "ROBOTS",
    "Exercise",
    "Outcome",
    "Robot",
    "Variant",
    "carry_out",
    "exercises",
    "missed",
    "perform",
    "perform_all",
    "program_of",
]

Robot = Literal["office", "drone"]
ROBOTS: Final[tuple[Robot, ...]] = ("office", "drone")

_NEAR: Final = 1.5
_ON: Final = 0.6
"""A drone stands on a tag when its middle is within so many metres of the tag's: the edge of a tag."""


class Variant(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An exercise for one robot: the program, and what has to be true in the world when it has ended."""

    program: str
    visits: tuple[str, ...] = ()
    ends: str | None = None
    lands: int | None = None
    near: int | None = None
    charge: float | None = None


class Exercise(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An exercise, for both robots."""

    number: int
    title: str
    office: Variant
    drone: Variant

    def of(self, robot: Robot) -> Variant:
        """Return what it is for a robot."""
        return self.office if robot == "office" else self.drone


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    exercise: tuple[Exercise, ...]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an exercise went: what was not reached, in words; seconds of the world and of the wall."""

    number: int
    robot: Robot
    missed: tuple[str, ...]
    simulated: float
    took: float


_PLACES: Final = "office-places.toml"
"""The places that the programs of the office name, which the simulated robot tells too."""


def _home() -> Path:
    return folder("examples") / "programs"


def exercises() -> tuple[Exercise, ...]:
    """Return the exercises by number."""
    return msgspec.toml.decode((_home() / "exercises.toml").read_bytes(), type=_File).exercise


def program_of(variant: Variant) -> Program:
    """Return the program of an exercise for one robot."""
    return placed(load(str(_home() / variant.program)).program, read_places(str(_home() / _PLACES)))


async def perform(exercise: Exercise, robot: Robot, settings: Settings) -> Outcome:
    """Carry an exercise out in a simulation of its own, as fast as can be; what it fails of is in the outcome.

    Raises:
        RobotError: KG840 when pybullet or OpenCV is not installed.
    """
    began = time.monotonic()
    async with hosted_in_memory(robot) as (simulation, address):
        try:
            wrong = await carry_out(program_of(exercise.of(robot)), address, settings)
        except RobotError as error:
            wrong = [f"{error.code}: {error.message}"]
        wrong += missed(exercise.of(robot), simulation.world)
        passed = simulation.world.time
    return Outcome(exercise.number, robot, tuple(wrong), passed, time.monotonic() - began)


async def perform_all(settings: Settings) -> list[Outcome]:
    """Carry all exercises out, for both robots; raises as `perform`."""
    return [await perform(exercise, robot, settings) for exercise in exercises() for robot in ROBOTS]


async def carry_out(program: Program, address: str, settings: Settings) -> list[str]:
    """Run a program on the robot at an address, as `kg robot run` does; return what went wrong."""
    connection = await connect(address, name="/kg_exercise")
    try:
        capabilities: Capabilities = infer(await connection.graph(), settings, address=address)
        problems = [one.message for one in check(program, capabilities) if one.severity == "error"]
        if problems:
            return problems
        async with Driver(connection, capabilities) as driver:
            ended = await Runner(driver, program).run()
        return [ended.problem.message] if ended.problem else []
    finally:
        await connection.aclose()


def missed(variant: Variant, world: World) -> list[str]:
    """Return what the world does not have that it should have, in words."""
    pose, robot = world.robot.pose, world.robot
    tags = {one.id: one for one in world.plan.tags}
    wrong: list[str] = []
    if not _in_order(variant.visits, world.visited):
        wrong.append(
            f"it visited {', '.join(world.visited) or 'nothing'}, not {', '.join(variant.visits)} in this order"
        )
    if variant.ends is not None and world.plan.room_at(pose.x, pose.y) != variant.ends:
        wrong.append(f"it ended at {pose.x:.1f}, {pose.y:.1f}, not in {variant.ends}")
    for tag, reach in ((variant.lands, _ON), (variant.near, _NEAR)):
        if tag is not None and pose.distance(tags[tag].x, tags[tag].y) > reach:
            wrong.append(f"it ended {pose.distance(tags[tag].x, tags[tag].y):.1f} m away from tag {tag}")
    if variant.lands is not None and not (isinstance(robot, Drone) and robot.state is State.LANDED):
        wrong.append("it did not land")
    if variant.charge is not None and robot.battery.charge > variant.charge:
        wrong.append(f"the battery still has {robot.battery.charge:.0%}")
    return wrong


def _in_order(wanted: Iterable[str], visited: Iterable[str]) -> bool:
    """Tell whether all that is wanted comes among what was visited, in this order."""
    rest = iter(visited)
    return all(one in rest for one in wanted)
