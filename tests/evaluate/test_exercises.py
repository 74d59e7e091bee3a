from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, get_args

import pytest
from cli.program import Program
from repository import ROOT

from kg.evaluate.exercises import (
    ROBOTS,
    Exercise,
    Outcome,
    Robot,
    Variant,
    capabilities_of_robots,
    capabilities_table,
    carry_out,
    exercises,
    exercises_table,
    missed,
    perform,
    program_of,
    runs_table,
)
from kg.robot.programs.files import SUFFIX, decode, encode, load
from kg.robot.simulation.plan import read_plan
from kg.robot.simulation.running import hosted_in_memory
from kg.robot.simulation.world import World
from kg.settings import Settings

if TYPE_CHECKING:
    from pathlib import Path

    from kg.robot.capability import Capabilities

EXERCISES = exercises()
FOLDER = ROOT / "examples" / "programs"
TEXTS = sorted(path.name for path in FOLDER.glob(f"*{SUFFIX}"))


def variants() -> list[tuple[Exercise, Robot]]:
    """Return every exercise with every robot."""
    return [(exercise, robot) for exercise in EXERCISES for robot in ROBOTS]


def test_there_are_four_exercises_for_both_robots() -> None:
    """Their programs are the files of the folder, each once."""
    assert [exercise.number for exercise in EXERCISES] == [1, 2, 3, 4]
    own = [name for name in TEXTS if name.startswith(ROBOTS)]  # the arm's program is not part of the paper
    assert sorted(exercise.of(robot).program for exercise, robot in variants()) == own
    assert get_args(Robot) == ROBOTS


@pytest.mark.parametrize("name", TEXTS)
def test_the_json_form_is_that_of_the_text(name: str) -> None:
    """The JSON next to each text is the same program."""
    written = (FOLDER / name).with_suffix(".json").read_bytes()
    program = load(str(FOLDER / name)).program
    assert decode(written) == program
    assert written == encode(program)


@pytest.mark.parametrize(("exercise", "robot"), variants())
def test_what_an_exercise_asks_for_is_in_the_world(exercise: Exercise, robot: Robot) -> None:
    """The rooms and tags of its goal exist."""
    plan, variant = read_plan(robot), exercise.of(robot)
    assert {*variant.visits, variant.ends} - {None} <= {room.name for room in plan.rooms}
    assert variant.task


@pytest.mark.parametrize(("exercise", "robot"), variants())
def test_the_exercise_reaches_its_goal(exercise: Exercise, robot: Robot) -> None:
    """The program, run in the simulation, reaches the goal of the exercise."""
    pytest.importorskip("pybullet", reason="worlds need pybullet")
    pytest.importorskip("cv2", reason="tags need OpenCV")
    outcome: Outcome = asyncio.run(perform(exercise, robot, Settings()))
    assert outcome.missed == ()
    assert outcome.simulated < (program_of(exercise.of(robot)).seconds or 0)


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_same_program_runs_in_ros_2(robot: Robot) -> None:
    """The program is independent of types, names and actions."""
    pytest.importorskip("pybullet", reason="worlds need pybullet")
    pytest.importorskip("cv2", reason="tags need OpenCV")
    variant = EXERCISES[1].of(robot)

    async def carried_out() -> list[str]:
        async with hosted_in_memory(robot, ros=2, start=variant.start) as (simulation, address):
            return await carry_out(program_of(variant), address, Settings()) + missed(variant, simulation.world)

    assert asyncio.run(carried_out()) == []


@pytest.mark.parametrize(("exercise", "robot"), variants())
def test_a_robot_that_did_nothing_reached_nothing(exercise: Exercise, robot: Robot) -> None:
    """The initial world fulfils no exercise, so the check can fail."""
    pytest.importorskip("pybullet", reason="worlds need pybullet")
    pytest.importorskip("cv2", reason="tags need OpenCV")
    variant = exercise.of(robot)
    with World(robot, start=variant.start) as world:
        world.advance()
        assert missed(variant, world)


def test_visits_count_in_their_order() -> None:
    """The same rooms in another order do not count."""
    pytest.importorskip("pybullet", reason="worlds need pybullet")
    with World("office") as world:
        world.visited[:] = ["corridor", "kitchen", "corridor", "office 2"]
        assert not missed(Variant(task="", program="", visits=("kitchen", "office 2")), world)
        assert missed(Variant(task="", program="", visits=("office 2", "kitchen")), world)


@pytest.fixture(scope="module")
def known() -> dict[str, Capabilities]:
    """Return the inferred capabilities of both robots."""
    pytest.importorskip("pybullet", reason="worlds need pybullet")
    pytest.importorskip("cv2", reason="tags need OpenCV")
    return asyncio.run(capabilities_of_robots(Settings()))


def test_the_capabilities_of_both_robots(known: dict[str, Capabilities]) -> None:
    """Table 1 has a row for each capability with a way, and its robots."""
    rows = {str(row[0]): row[2:] for row in capabilities_table(known, {}).rows}
    assert rows["go to a pose"] == ("yes", "")
    assert rows["take off"] == rows["land"] == rows["stop in an emergency"] == ("", "yes")
    for both in ("move at a velocity", "recognize tags", "see", "sense its pose", "sense its battery"):
        assert rows[both] == ("yes", "yes")


def test_rows_of_the_paper_stand_beside_ours(known: dict[str, Capabilities]) -> None:
    """The paper's robots have columns, and capabilities only in the paper have rows."""
    table = capabilities_table(known, {"office": ["goingToPose", "brewing"]})
    assert table.columns == ("capability", "kind", "office", "drone", "onto-ros office")
    rows = {str(row[0]): row[2:] for row in table.rows}
    assert rows["go to a pose"] == ("yes", "", "yes")
    assert rows["brewing"] == ("", "", "yes")
    assert table.notes == ()


def test_programs_take_less_than_code(known: dict[str, Capabilities]) -> None:
    """Table 2 has eight rows; every program has fewer blocks than its code has lines."""
    table = exercises_table(known)
    assert table.columns[:7] == ("exercise", "robot", "blocks", "capabilities", "lines", "components", "message types")
    assert len(table.rows) == 8
    for row in table.rows:
        figures = [cell for cell in row[2:7] if isinstance(cell, int)]
        assert len(figures) == 5
        assert min(figures) > 0
        assert figures[0] < figures[2]


def test_figures_of_the_paper_stand_beside_ours(known: dict[str, Capabilities]) -> None:
    """A known figure has its column, which is empty for other exercises."""
    table = exercises_table(known, {"1 office": {"lines": 60}})
    assert table.columns[7:] == ("onto-ros lines",)
    assert [row[7] for row in table.rows] == [60, *[None] * 7]


def test_without_figures_of_the_paper_that_is_said(known: dict[str, Capabilities]) -> None:
    """Without figures the table has no column for them, and a note."""
    (note,) = exercises_table(known, {}).notes
    assert "onto-ros.toml" in note


def test_runs_say_what_was_not_reached() -> None:
    """A failed exercise has the reasons in place of `reached`."""
    good = Outcome(1, "office", (), 41.0, 3.0)
    bad = Outcome(2, "drone", ("it did not land", "it ended 3.0 m away from tag 12"), 20.0, 2.0)
    assert [row[2] for row in runs_table([good, bad]).rows] == [
        "reached",
        "it did not land; it ended 3.0 m away from tag 12",
    ]


def test_the_command_prints_table_2(tmp_path: Path) -> None:
    """`kg eval exercises` needs no store; `--capabilities` is Table 1."""
    kg = Program(tmp_path)
    pytest.importorskip("pybullet", reason="worlds need pybullet")
    pytest.importorskip("cv2", reason="tags need OpenCV")
    table = kg("eval", "exercises", "--json")
    assert table.code == 0, table.err
    assert len(table.out.splitlines()) == 8
    assert "take off" in kg("eval", "exercises", "--capabilities").out
