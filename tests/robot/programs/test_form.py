"""Programs as JSON and back."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from repository import ROOT
from robot.programs.trees import programs

from kg.errors import RobotError
from kg.robot.programs.files import decode, encode, schema

if TYPE_CHECKING:
    from kg.robot.programs.tree import Program


@settings(max_examples=200)
@given(programs)
def test_json_is_read_as_the_same_tree(program: Program) -> None:
    """Every tree survives the JSON form."""
    assert decode(encode(program)) == program


def test_the_published_schema_is_that_of_the_tree() -> None:
    """docs/program.schema.json matches the tree."""
    published = json.loads((ROOT / "docs/program.schema.json").read_text(encoding="utf-8"))
    assert published == schema()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "truncated"),
        ('{"body": [{"block": "fly"}]}', "Invalid value 'fly' - at `$.body[0].block`"),
        ('{"body": [{"block": "break", "speed": 1}]}', "unknown field `speed` - at `$.body[0]`"),
        (
            '{"body": [{"block": "wait", "seconds": {"expression": "value", "value": 1, "unit": "x"}}]}',
            "`x` is not a unit",
        ),
        ('{"body": [{"block": "for", "variable": "i"}]}', "`for` needs either"),
        ('{"version": 2}', "version"),
        ("[" * 100_000, ""),
    ],
)
def test_other_json_is_refused(text: str, message: str) -> None:
    """JSON that is not a program is an error with the path to the part."""
    with pytest.raises(RobotError, match="KG831") as raised:
        decode(text)
    assert message in str(raised.value)
