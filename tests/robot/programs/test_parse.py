"""Programs as people write them."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from kg.errors import RobotError
from kg.robot.programs.files import decode
from kg.robot.programs.parse import parse, parse_with_places
from kg.robot.programs.tree import Do, Stop, Written
from kg.robot.programs.write import write

CASES = Path(__file__).parent / "cases" / "parse"
WORDS = (
    "if then otherwise end while repeat times for each in from to step do break set wait until within at the same time",
    "also whenever as soon during log stop program and or not contains of true x 3 2.5 m 4 cm % ( ) , : = < <= + - * /",
    "count absolute # ; 'n' @i",
)
TOKENS = [*" ".join(WORDS).split(" "), '"t"', "\n", "\n", "\n"]


@pytest.mark.parametrize("case", sorted(CASES.glob("*.kgp")), ids=lambda path: path.stem)
def test_programs_are_forgiving(case: Path) -> None:
    """A program in any layout equals the expected one of the printer."""
    assert write(parse(case.read_text(encoding="utf-8"))) == case.with_suffix(".printed").read_text(encoding="utf-8")


@settings(max_examples=150, deadline=None)
@example("wait for until")
@given(st.lists(st.sampled_from(TOKENS), max_size=30).map(" ".join) | st.text(max_size=40))
def test_any_text_is_read_or_refused(text: str) -> None:
    """Invalid text is an error with a place; valid text survives."""
    try:
        program = parse(text)
    except RobotError as error:
        place = error.place
    else:
        assert parse(write(program, ids=True)) == program
        return
    assert place is not None
    assert 1 <= (place.line or 0) <= text.count("\n") + 1


@pytest.mark.parametrize(
    "text",
    [
        "log " + "(" * 5000 + "1" + ")" * 5000,
        "log " + "- " * 5000 + "1",
        "log " + "not " * 5000 + "true",
        "log " + " + ".join("1" * 5000),
        "repeat 2 times\n" * 5000 + "end\n" * 5000,
        "if true then\n" + "otherwise if true then\n" * 5000 + "end\n",
    ],
    ids=["parentheses", "signs", "not", "chain", "blocks", "otherwise"],
)
def test_nothing_stands_too_deep(text: str) -> None:
    """Excessive nesting is an error, before Python's own limit."""
    with pytest.raises(RobotError, match="nested"):
        parse(text)


def test_json_stands_no_deeper() -> None:
    """The limit is the same for JSON."""
    deep = '{"expression": "value", "value": true}'
    for _ in range(60):
        deep = f'{{"expression": "unary", "operator": "not", "of": {deep}}}'
    with pytest.raises(RobotError, match="nested"):
        decode(f'{{"body": [{{"block": "log", "message": {deep}}}]}}')


def test_time_grows_with_the_length_of_a_program() -> None:
    """Four times as many statements take about four times as long to parse, and not sixteen times."""

    def seconds(statements: int) -> float:
        text = "move at a velocity  forward: 0.1 m/s + 2 * x, turn: 3 deg/s for 2 s\n" * statements
        begun = time.process_time()
        assert len(parse(text).body) == statements
        return time.process_time() - begun

    assert min(seconds(1_200) for _ in range(3)) < 9 * min(seconds(300) for _ in range(3))


def test_places_lead_to_parts() -> None:
    """Each part of the tree has its line and column."""
    _, places = parse_with_places('\nif x < 1 m + 2 s then\n  log "a"\notherwise\n  stop\nend')
    assert places["/body/0"] == (2, 1)
    assert places["/body/0/condition/right/right"] == (2, 14)
    assert places["/body/0/then/0/message"] == (3, 7)
    assert places["/body/0/otherwise/0"] == (5, 3)


def test_words_of_the_language_are_told_from_capabilities() -> None:
    """`stop` alone ends the program; with more words it is a capability."""
    stop, other = parse("stop\nstop in an emergency").body
    assert isinstance(stop, Stop)
    assert isinstance(other, Do)
    assert other.capability == "stop in an emergency"


def test_times_of_programs_are_seconds() -> None:
    """The tree has seconds, whatever the unit."""
    assert parse('program "p" within 5 min').seconds == 300
    (do,) = parse("go to a pose  x: 1 within 2 minutes").body
    assert isinstance(do, Do)
    assert do.within == Written(value=2, unit="min")
