"""Tables 1 and 2 of the onto-ros paper (section 4) for our robots and exercises, and for a study, with its figures.

The known rows and figures of the paper are in `corpus/onto-ros.toml`.
"""

from __future__ import annotations

import csv
from pathlib import Path
from statistics import fmean, stdev
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.errors import Place, UsageError
from kg.evaluate.exercises import ROBOTS, Outcome, exercises, program_of
from kg.evaluate.tables import Cell, Table
from kg.resources import table_of
from kg.robot.connecting import connect
from kg.robot.live import infer
from kg.robot.programs.converting import convert
from kg.robot.programs.metrics import code_metrics, metrics
from kg.robot.simulation.running import hosted_in_memory

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.robot.capability import Capabilities
    from kg.settings import Settings


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
            raise UsageError("KG003", message, place=Place(path, number), hint=hint) from error
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
