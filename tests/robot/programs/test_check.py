"""Problems of programs: each program in cases/check with its expected problems."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import pytest
from hypothesis import given, settings
from robot.programs.trees import programs
from robot.programs.trolley import CAPABILITIES

from kg.errors import RobotError
from kg.robot.programs.check import check
from kg.robot.programs.events import place_at
from kg.robot.programs.parse import parse, parse_with_places

if TYPE_CHECKING:
    from kg.robot.programs.tree import Program

CASES = Path(__file__).parent / "cases" / "check"


def told(text: str) -> list[str]:
    """Return the problems of a program as lines."""
    try:
        program, places = parse_with_places(text, "p")
    except RobotError as error:
        return [f"{error.place} {error.code} {error.message} | {error.hint}"]
    found = []
    for problem in check(program, CAPABILITIES):
        place = place_at("p", text, places, problem.path)
        found.append(f"{place} {problem.severity} {problem.code} {problem.message} | {problem.hint}")
    return found


@pytest.mark.parametrize("case", sorted(CASES.glob("*.kgp")), ids=lambda path: path.stem)
def test_what_is_wrong_is_found(case: Path) -> None:
    """Every problem is reported at its line and column, with instructions."""
    text = case.read_text(encoding="utf-8")
    assert told(text) == case.with_suffix(".problems").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("case", sorted((CASES.parent / "run").glob("*.kgp")), ids=lambda path: path.stem)
def test_sound_programs_pass(case: Path) -> None:
    """Programs that run have no errors, except those that demonstrate one."""
    found = [line for line in told(case.read_text(encoding="utf-8")) if " error " in line]
    assert bool(found) == (case.stem in {"break", "spin"})


def test_a_problem_is_at_its_block() -> None:
    """The id is that of the statement at the path, however deep."""
    (problem,) = check(parse('if true then @"a"\n log 1 m + 2 s @"b"\nend'), CAPABILITIES)
    assert (problem.id, problem.path) == ("b", "/body/0/then/0/message")


@settings(max_examples=100, deadline=None)
@given(programs)
def test_any_tree_can_be_checked(program: Program) -> None:
    """For any tree, the problems are located at existing parts."""
    tree = msgspec.to_builtins(program)
    for problem in check(program, CAPABILITIES):
        part = tree
        for step in problem.path.split("/")[1:]:
            part = part.get(step, {}) if isinstance(part, dict) else part[int(step)]
