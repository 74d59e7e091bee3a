"""Units of measurement."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.robot.programs.units import PLAIN, UNITS, convert, described, divided, multiplied, unit_of

SYMBOLS = st.sampled_from(sorted(UNITS))


@pytest.mark.parametrize(
    ("value", "unit", "to", "expected"),
    [
        (50, "cm", "m", 0.5),
        (36, "km/h", "m/s", 10),
        (180, "deg", "rad", math.pi),
        (20, "%", None, 0.2),
        (2, "min", "s", 120),
    ],
)
def test_units_convert(value: float, unit: str, to: str | None, expected: float) -> None:
    """A value can be converted to any unit of the same quantity."""
    assert convert(value, unit, to) == pytest.approx(expected)


def test_what_measures_something_else_does_not_convert() -> None:
    """Metres do not convert to seconds, and words are not units."""
    with pytest.raises(ValueError, match="m is not s"):
        convert(1, "m", "s")
    with pytest.raises(LookupError):
        convert(1, "parsec", "m")


@given(SYMBOLS, SYMBOLS)
def test_quotients_undo_products(one: str, other: str) -> None:
    """Multiplying and dividing by a unit preserves the dimension."""
    left, right = UNITS[one].dimension, UNITS[other].dimension
    assert divided(multiplied(left, right), right) == left
    assert divided(left, left) == PLAIN


def test_dimensions_are_described_by_units() -> None:
    """Speed times time is a length; a dimension without a unit is a product of the known ones."""
    assert described(multiplied(UNITS["km/h"].dimension, UNITS["min"].dimension)) == "m"
    assert described(multiplied(UNITS["m"].dimension, UNITS["m"].dimension)) == "m^2"
    assert described(PLAIN) == "a plain number"
    assert unit_of("seconds").symbol == "s"
