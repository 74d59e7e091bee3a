"""Hints of errors of the text form."""

from __future__ import annotations

import pytest

from kg.errors import RobotError
from kg.robot.programs.parse import parse
from kg.robot.programs.write import write


def test_set_without_to() -> None:
    """A value without `to` is not taken for that of a capability."""
    with pytest.raises(RobotError) as refused:
        parse("set speed 3")
    assert refused.value.hint == "Write `set speed to 3`."


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ('if 1 < 2\n log "a"\nelse\n log "b"\nend', "Write `otherwise`."),
        ('if 1 < 2\n log "a"\nelif 1 < 3\n log "b"\nend', "Write `otherwise if`."),
        ('print "x"', 'Write `log "..."`.'),
        ("let speed = 3", "Write `set speed to 3`."),
        ("let speed be 3", "Write `set x to 3`."),
        ("speed = 3", "Write `set speed to 3`."),
        ("if 1 <> 2\nend", "Write `!=`."),
    ],
)
def test_words_of_other_languages(text: str, hint: str) -> None:
    """Keywords of other languages are not taken for a capability; the hint gives the equivalent."""
    with pytest.raises(RobotError) as refused:
        parse(text)
    assert (refused.value.code, refused.value.hint) == ("KG830", hint)


@pytest.mark.parametrize("name", ["else", "print", "let go"])
def test_a_capability_of_such_a_name(name: str) -> None:
    """In quotes such a name is a capability, and it is printed so."""
    program = parse(f"do '{name}'")
    assert parse(write(program)) == program
