"""The exercises of the onto-ros paper (section 4.2) in its words: programs, and checks of the resulting world.

They are in `examples/programs/`; `exercises.toml` there has the goals. They are checked in the simulated world itself,
not by the robot's measurements. Tables 1 and 2 of the paper (section 4) are made for our robots, for the exercises and
for the results of a study; the known figures of the paper are in `corpus/onto-ros.toml`.
"""

from __future__ import annotations

import csv
import math
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, stdev
from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from kg.errors import Place as SourcePlace
from kg.errors import RobotError, UsageError
from kg.evaluate.tables import Cell, Table
from kg.resources import folder, table_of
from kg.robot.connecting import connect
from kg.robot.driving import Driver
from kg.robot.live import infer
from kg.robot.programs.check import check
from kg.robot.programs.converting import convert
from kg.robot.programs.files import load
from kg.robot.programs.metrics import code_metrics, metrics
from kg.robot.programs.places import placed, read_places
from kg.robot.programs.runner import Runner
from kg.robot.simulation.drone import Drone, State
from kg.robot.simulation.plan import Place  # noqa: TC001 - msgspec reads the annotation
from kg.robot.simulation.running import hosted_in_memory

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

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
    far, widest = _VIEW
    bearing = math.atan2(tag.y - pose.y, tag.x - pose.x) - pose.heading
    return pose.distance(tag.x, tag.y) <= far and abs(math.remainder(bearing, math.tau)) <= widest


PAPER: Final = "onto-ros"
_FIGURES: Final = ("blocks", "capabilities", "lines", "components", "message types")


async def capabilities_of_robots(settings: Settings) -> dict[str, Capabilities]:
    """Return the inferred capabilities of each simulated robot.

    Raises RobotError: KG840 pybullet or OpenCV is not installed.
    """
    inferred: dict[str, Capabilities] = {}
    for robot in ROBOTS:
        async with hosted_in_memory(robot) as (_, address):
            face = await connect(address, name="/kg_evaluation")
            inferred[robot] = infer(await face.graph(), settings, address=address)
            await face.aclose()
    return inferred


def capabilities_table(of: Mapping[str, Capabilities], paper: Mapping[str, list[str]] | None = None) -> Table:
    """Return Table 1: the capabilities with interfaces, and which robot has them.

    `paper` has the capabilities in the paper by robot, by default those of the file. It adds a column for each of its
    robots, and rows for capabilities that only it has.
    """
    paper = paper_figures("capabilities") if paper is None else paper
    reached = {robot: {one.name for one in capabilities.capabilities if one.ways} for robot, capabilities in of.items()}
    kinds = {one.name: (one.kinds[0], one.label) for capabilities in of.values() for one in capabilities.capabilities}
    every = set().union(*reached.values(), *paper.values())
    names = sorted(every, key=lambda name: (*kinds.get(name, ("~", name)), name))
    rows = [
        (
            *reversed(kinds.get(name, ("", name))),
            *(_mark(name in reached[robot]) for robot in reached),
            *(_mark(name in some) for some in paper.values()),
        )
        for name in names
    ]
    columns = ("capability", "kind", *reached, *(f"{PAPER} {robot}" for robot in paper))
    return Table("capabilities", "Capabilities inferred (onto-ros, Table 1)", columns, tuple(rows), _notes(paper))


def _mark(has: bool) -> str:  # noqa: FBT001 - what it marks
    return "yes" if has else ""


def exercises_table(of: Mapping[str, Capabilities], paper: Mapping[str, Mapping[str, float]] | None = None) -> Table:
    """Return Table 2: the size of each exercise as a program, and as equivalent expert code.

    The code is the output of `kg robot convert --to rospy`. `paper` has figures by exercise and robot (`1 office`), by
    default those of the file; known ones are columns.
    """
    paper = paper_figures("exercises") if paper is None else paper
    measured = [name for name in _FIGURES if any(name in figures for figures in paper.values())]
    rows: list[tuple[Cell, ...]] = []
    for exercise in exercises():
        for robot in ROBOTS:
            program = program_of(exercise.of(robot))
            ours, code = metrics(program), code_metrics(convert(program, of[robot], to="rospy"))
            figures = (ours.blocks, ours.capabilities, code.lines, code.components, code.message_types)
            published = paper.get(f"{exercise.number} {robot}", {})
            rows.append(
                (f"{exercise.number} {exercise.title}", robot, *figures, *(published.get(name) for name in measured))
            )
    columns = ("exercise", "robot", *_FIGURES, *(f"{PAPER} {name}" for name in measured))
    return Table("exercises", "Programs compared with code (onto-ros, Table 2)", columns, tuple(rows), _notes(paper))


def _notes(paper: Mapping[str, object]) -> tuple[str, ...]:
    return () if paper else ("the paper's own rows are not known: `corpus/onto-ros.toml` has none",)


def runs_table(outcomes: Iterable[Outcome]) -> Table:
    """Return the results of the exercises in the simulation."""
    titles = {one.number: one.title for one in exercises()}
    rows = tuple(
        (
            f"{one.number} {titles[one.number]}",
            one.robot,
            "; ".join(one.missed) or "reached",
            f"{one.simulated:.1f} s",
            f"{one.took:.1f} s",
        )
        for one in outcomes
    )
    return Table("runs", "Exercises carried out", ("exercise", "robot", "goal", "simulated", "took"), rows)


def paper_figures(table: str) -> dict[str, Any]:
    """Return a table of the paper's figures: by robot, or by exercise and robot (`1 office`)."""
    content: dict[str, Any] = table_of("corpus", "onto-ros.toml")[table]
    return content


_COLUMNS: Final = (
    *("exercise", "robot", "participants", "time", "attempts", "done", "blocks", "capabilities"),
    "onto-ros time",
)


class Result(msgspec.Struct, frozen=True, kw_only=True):
    """A task solved by a participant: wall-clock seconds, runs, the result of the last one, and its size."""

    participant: str
    robot: str
    exercise: int
    title: str
    seconds: float
    attempts: int
    ended: str
    blocks: int
    capabilities: int
    program: str = ""


def read(path: str) -> list[Result]:
    """Return the results in a file.

    Raises UsageError: KG003 an unreadable or invalid file.
    """
    try:
        rows = list(csv.DictReader(Path(path).read_text("utf-8").splitlines(keepends=True)))
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "the text is not in UTF-8"
        raise UsageError("KG003", f"`{path}` cannot be read: {reason}") from error
    results = []
    for number, row in enumerate(rows, start=2):
        try:
            results.append(msgspec.convert(row, Result, strict=False))
        except msgspec.ValidationError as error:
            hint = "Save the results on the robot page: Examples, Study with four tasks."
            message = f"not a result of a study: {error}"
            raise UsageError("KG003", message, place=SourcePlace(path, number), hint=hint) from error
    return results


def table(results: Sequence[Result]) -> Table:
    """Return means by exercise and robot, next to the times of the paper."""
    titles = {one.number: one.title for one in exercises()}
    groups = sorted({(one.exercise, one.robot) for one in results}, key=lambda one: (one[1] != "office", one[0]))
    published = paper_figures("exercises")
    rows: list[tuple[Cell, ...]] = []
    for exercise, robot in groups:
        paper = published.get(f"{exercise} {robot}")
        some = [one for one in results if (one.exercise, one.robot) == (exercise, robot)]
        seconds = [one.seconds for one in some]
        deviation = f" ± {_clock(stdev(seconds))}" if len(seconds) > 1 else ""
        rows.append((
            f"{exercise} {titles.get(exercise, some[0].title)}",
            robot,
            len({one.participant for one in some}),
            _clock(fmean(seconds)) + deviation,
            _mean([one.attempts for one in some]),
            sum(one.ended != "failed" for one in some),
            _mean([one.blocks for one in some]),
            _mean([one.capabilities for one in some]),
            f"{_clock(paper['seconds'])} ± {_clock(paper['deviation'])}" if paper else None,
        ))  # fmt: skip
    return Table("study", "Tasks solved by participants (onto-ros, section 4.3)", _COLUMNS, tuple(rows))


def _mean(numbers: Sequence[int]) -> str:
    return f"{fmean(numbers):.1f}".removesuffix(".0")


def _clock(seconds: float) -> str:
    return f"{int(seconds + 0.5) // 60}:{int(seconds + 0.5) % 60:02}"
