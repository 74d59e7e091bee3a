"""The exercises of the onto-ros paper (section 4.2) in its words: programs, and checks of the resulting world.

They are in `examples/programs/`; `exercises.toml` there has the goals. They are checked in the simulated world itself,
not by the robot's measurements.
"""

from __future__ import annotations

import math
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
from kg.robot.simulation.plan import Place  # noqa: TC001 - msgspec reads the annotation
from kg.robot.simulation.running import hosted_in_memory

if TYPE_CHECKING:
    from pathlib import Path

    from kg.robot.capability import Capabilities
    from kg.robot.programs.tree import Program
    from kg.robot.simulation.plan import TagPlace
    from kg.robot.simulation.robots import Pose
    from kg.robot.simulation.world import World
    from kg.settings import Settings

Robot = Literal["office", "drone"]
ROBOTS: Final[tuple[Robot, ...]] = ("office", "drone")

_VIEW: Final = (12.0, math.radians(35))
"""Maximum distance and bearing of a tag that the robot faces."""


class Variant(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An exercise for one robot: the task, the program, and the conditions on the world at the end.

    `start` is the initial pose, by default that of the plan; lengths are in metres, angles in degrees.
    """

    task: str
    program: str
    start: Place | None = None
    visits: tuple[str, ...] = ()
    ends: str | None = None
    moves: float = 0.0
    turns: float = 0.0
    rises: int = 0
    lands: bool = False
    faces_tag: bool = False


class Exercise(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An exercise, for both robots."""

    number: int
    title: str
    office: Variant
    drone: Variant

    def of(self, robot: Robot) -> Variant:
        """Return the variant for a robot."""
        return self.office if robot == "office" else self.drone


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    exercise: tuple[Exercise, ...]


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of an exercise: missed goals, in words; seconds of the world and of the wall clock."""

    number: int
    robot: Robot
    missed: tuple[str, ...]
    simulated: float
    took: float


_PLACES: Final = "office-places.toml"
"""The places named in the programs of the office, which the simulated robot also publishes."""


def _home() -> Path:
    return folder("examples") / "programs"


def exercises() -> tuple[Exercise, ...]:
    """Return the exercises by number."""
    return msgspec.toml.decode((_home() / "exercises.toml").read_bytes(), type=_File).exercise


def program_of(variant: Variant) -> Program:
    """Return the program of an exercise for one robot."""
    return placed(load(str(_home() / variant.program)).program, read_places(str(_home() / _PLACES)))


async def perform(exercise: Exercise, robot: Robot, settings: Settings) -> Outcome:
    """Run an exercise in a simulation of its own, as fast as possible; missed goals are in the outcome.

    Raises RobotError: KG840 pybullet or OpenCV is not installed.
    """
    began = time.monotonic()
    async with hosted_in_memory(robot, start=exercise.of(robot).start) as (simulation, address):
        try:
            wrong = await carry_out(program_of(exercise.of(robot)), address, settings)
        except RobotError as error:
            wrong = [f"{error.code}: {error.message}"]
        wrong += missed(exercise.of(robot), simulation.world)
        passed = simulation.world.time
    return Outcome(exercise.number, robot, tuple(wrong), passed, time.monotonic() - began)


async def perform_all(settings: Settings) -> list[Outcome]:
    """Run all exercises for both robots; raises as `perform`."""
    return [await perform(exercise, robot, settings) for exercise in exercises() for robot in ROBOTS]


async def carry_out(program: Program, address: str, settings: Settings) -> list[str]:
    """Run a program on the robot at an address, as `kg robot run` does; return the failures."""
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
    """Return the missed goals, in words."""
    pose, robot, start = world.robot.pose, world.robot, world.start
    wrong: list[str] = []
    # The visited places contain the wanted ones in order: the search for one continues behind the one before.
    places = iter(world.visited)
    if not all(one in places for one in variant.visits):
        wrong.append(
            f"it visited {', '.join(world.visited) or 'nothing'}, not {', '.join(variant.visits)} in this order"
        )
    if variant.ends is not None and world.plan.room_at(pose.x, pose.y) != variant.ends:
        wrong.append(f"it ended at {pose.x:.1f}, {pose.y:.1f}, not in {variant.ends}")
    if pose.distance(start.x, start.y) < variant.moves:
        wrong.append(f"it ended {pose.distance(start.x, start.y):.1f} m away from where it began")
    if math.degrees(world.turned) < variant.turns:
        wrong.append(f"it turned by {math.degrees(world.turned):.0f} degrees")
    if world.rises < variant.rises:
        wrong.append(f"it rose {world.rises} times")
    if variant.lands and not (isinstance(robot, Drone) and robot.state is State.LANDED):
        wrong.append("it did not land")
    if variant.faces_tag and not any(_faces(pose, tag) for tag in world.plan.tags):
        wrong.append(f"it ended at {pose.x:.1f}, {pose.y:.1f} without a tag in front of it")
    return wrong


def _faces(pose: Pose, tag: TagPlace) -> bool:
    """Return whether a robot faces a tag."""
    far, widest = _VIEW
    bearing = math.atan2(tag.y - pose.y, tag.x - pose.x) - pose.heading
    return pose.distance(tag.x, tag.y) <= far and abs(math.remainder(bearing, math.tau)) <= widest
