"""Results of a user study, as section 4.3 of the onto-ros paper reports them.

The robot page saves them as CSV: a row for each task for which a participant ran a program. The time of a task is from
the end of its description to the last run of the program.
"""

from __future__ import annotations

import csv
from pathlib import Path
from statistics import fmean, stdev
from typing import TYPE_CHECKING, Final

import msgspec

from kg.errors import Place, UsageError
from kg.evaluate.exercise_tables import paper_figures
from kg.evaluate.exercises import exercises
from kg.evaluate.tables import Cell, Table

if TYPE_CHECKING:
    from collections.abc import Sequence


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
