from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given as examples
from hypothesis import strategies as st

from kg.errors import RobotError
from kg.robot.capability import Capability, Parameter
from kg.robot.driving.arguments import given, in_words

CAPABILITY = Capability(
    iri="#all",
    name="all",
    label="All",
    modality="write",
    parameters=(
        Parameter(name="x", label="x", unit="m", minimum=-1, maximum=1, default=0.0),
        Parameter(name="turn", label="turn", unit="rad/s", default=0.0),
        Parameter(name="times", label="times", type="integer", minimum=1),
        Parameter(name="on", label="on", type="boolean", default=False),
        Parameter(name="mode", label="mode", type="text", choices=("slow", "fast"), default="slow"),
        Parameter(name="places", label="places", type="list"),
        Parameter(name="share", label="share"),
    ),
)
DEFAULTS = {"x": 0.0, "turn": 0.0, "on": False, "mode": "slow"}


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("x", "0.5", 0.5),
        ("x", "30cm", 0.3),
        ("x", " -300 mm ", -0.3),
        ("x", "1e-3", 0.001),
        ("x", 1, 1.0),
        ("x", 1.0000000001, 1.0000000001),
        ("turn", "45deg/s", math.pi / 4),
        ("times", "3", 3),
        ("times", 3.0, 3),
        ("on", "yes", True),
        ("on", "OFF", False),
        ("on", True, True),
        ("mode", "fast", "fast"),
        ("places", "1,2.5,kitchen", [1.0, 2.5, "kitchen"]),
        ("places", (1, 2), [1, 2]),
        ("share", "50%", 0.5),
    ],
)
def test_values_are_converted(name: str, value: object, expected: object) -> None:
    """Texts and numbers become values in the parameter's unit and kind; missing ones have their defaults."""
    found = given(CAPABILITY, {name: value})
    assert found.pop(name) == (pytest.approx(expected) if isinstance(expected, float) else expected)
    assert found == {other: default for other, default in DEFAULTS.items() if other != name}


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("x", "1.5", "more than 1 m"),
        ("x", "-150cm", "less than -1 m"),
        ("x", "fast", "not a number"),
        ("x", "", "not a number"),
        ("x", "1 furlong", "unknown unit"),
        ("x", "10deg", "rad is not m"),
        ("x", True, "not a number"),
        ("x", "nan", "not a number"),
        ("x", math.nan, "not a number"),
        ("x", math.inf, "not a number"),
        ("x", [1], "not a number"),
        ("turn", 10**400, "not a number"),
        ("x", None, "nothing"),
        ("times", "1.5", "not a whole number"),
        ("times", "0", "less than 1"),
        ("on", "perhaps", "neither true nor false"),
        ("on", 1, "neither true nor false"),
        ("mode", "fats", "not one of its choices"),
        ("mode", 3, "not text"),
        ("places", 3, "not a list"),
        ("y", "1", "no parameter"),
    ],
)
def test_what_does_not_fit_is_refused(name: str, value: object, says: str) -> None:
    """A value of another kind or unit, or out of the limits, is KG823 with the valid ones; it is never clamped."""
    with pytest.raises(RobotError) as refused:
        given(CAPABILITY, {name: value})
    assert refused.value.code == "KG823"
    assert says in refused.value.message
    assert refused.value.hint


@examples(st.one_of(st.floats(), st.text(max_size=12), st.integers(), st.booleans(), st.none()))
def test_limits_hold_for_everything(value: Any) -> None:
    """Any value is within the limits after conversion, or rejected."""
    try:
        found = given(CAPABILITY, {"x": value})
    except RobotError as error:
        assert error.code == "KG823"  # noqa: PT017 - either is right
    else:
        assert -1.00001 <= float(found["x"]) <= 1.00001  # type: ignore[arg-type]  # a number, as the parameter is


def test_parameters_in_words() -> None:
    """The domain of a parameter is described in a few words."""
    words = {one.name: in_words(one) for one in CAPABILITY.parameters}
    assert words == {
        "x": "a number in m, from -1 to 1, by default 0",
        "turn": "a number in rad/s, by default 0",
        "times": "a whole number, at least 1",
        "on": "true or false, by default false",
        "mode": "one of slow, fast, by default slow",
        "places": "a list",
        "share": "a number",
    }
