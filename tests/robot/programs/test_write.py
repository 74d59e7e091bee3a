"""Programs as text and back."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import given, settings
from patience import examples
from robot.programs.trees import expressions, programs

from kg.robot.programs.parse import parse
from kg.robot.programs.tree import Do, Log, Program
from kg.robot.programs.write import write, written

if TYPE_CHECKING:
    from kg.robot.programs.tree import Expression


@settings(max_examples=examples(100, 300))
@given(programs)
def test_what_is_written_is_read_as_the_same_tree(program: Program) -> None:
    """Every tree survives the text form, with its comments and its ids."""
    assert parse(write(program, ids=True)) == program


@settings(max_examples=100)
@given(programs)
def test_what_is_written_stays_as_it_is(program: Program) -> None:
    """Parsing and writing again changes nothing."""
    text = write(program)
    assert write(parse(text)) == text


@settings(max_examples=examples(100, 300))
@given(expressions)
def test_expressions_keep_their_structure(expression: Expression) -> None:
    """Parentheses are written if they are needed."""
    (log,) = parse(f"log {written(expression)}").body
    assert isinstance(log, Log)
    assert log.message == expression


def test_an_identity_begins_no_time() -> None:
    """A capability may end with `for`, followed by a parenthesised identity."""
    program = Program(body=(Do(id="(", capability="look for"),))
    assert parse(write(program, ids=True)) == program
