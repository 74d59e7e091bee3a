"""Units of measurement and their conversion.

A dimension is a product of base units with exponents, so speed times time is a length. Angles have a dimension of their
own, to catch degrees given for metres; a percentage is a plain number.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, TypeAlias

Dimension: TypeAlias = tuple[tuple[str, int], ...]
"""Base units with their exponents, sorted; empty for a plain number."""

PLAIN: Final[Dimension] = ()


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: its symbol, its dimension, and its size in base units."""

    symbol: str
    dimension: Dimension
    factor: float = 1.0


def _unit(symbol: str, factor: float = 1.0, **bases: int) -> Unit:
    return Unit(symbol, tuple(sorted(bases.items())), factor)


UNITS: Final = {
    unit.symbol: unit
    for unit in (
        _unit("m", m=1),
        _unit("cm", 0.01, m=1),
        _unit("mm", 0.001, m=1),
        _unit("km", 1000, m=1),
        _unit("s", s=1),
        _unit("ms", 0.001, s=1),
        _unit("min", 60, s=1),
        _unit("h", 3600, s=1),
        _unit("m/s", m=1, s=-1),
        _unit("cm/s", 0.01, m=1, s=-1),
        _unit("km/h", 1 / 3.6, m=1, s=-1),
        _unit("m/s^2", m=1, s=-2),
        _unit("rad", rad=1),
        _unit("deg", math.pi / 180, rad=1),
        _unit("rad/s", rad=1, s=-1),
        _unit("deg/s", math.pi / 180, rad=1, s=-1),
        _unit("rad/s^2", rad=1, s=-2),
        _unit("%", 0.01),
        _unit("Hz", s=-1),
        _unit("kg", kg=1),
        _unit("N", kg=1, m=1, s=-2),
        _unit("Nm", kg=1, m=2, s=-2),
        _unit("Pa", kg=1, m=-1, s=-2),
        _unit("V", V=1),
        _unit("A", A=1),
        _unit("degC", degC=1),
        _unit("lx", lx=1),
        _unit("T", T=1),
    )
}
"""The units by their symbols. Temperatures are in degrees Celsius only."""

ALIASES: Final = {
    **dict.fromkeys(("metre", "metres", "meter", "meters"), "m"),
    **dict.fromkeys(("second", "seconds", "sec"), "s"),
    **dict.fromkeys(("minute", "minutes"), "min"),
    **dict.fromkeys(("hour", "hours"), "h"),
    **dict.fromkeys(("degree", "degrees", "°"), "deg"),
    **dict.fromkeys(("volt", "volts"), "V"),
    "percent": "%",
    "°C": "degC",
    "°/s": "deg/s",
    "m/s²": "m/s^2",
    "rad/s²": "rad/s^2",
}
"""Other spellings of units."""

_NAMES: Final = {unit.dimension: symbol for symbol, unit in reversed(UNITS.items()) if unit.factor == 1}


def unit_of(symbol: str | None) -> Unit:
    """Return the unit of a symbol or alias, that of plain numbers for None; LookupError if it is unknown."""
    if symbol is None:
        return Unit("", PLAIN)
    return UNITS[ALIASES.get(symbol, symbol)]


def convert(value: float, unit: str | None, to: str | None) -> float:
    """Return a value in another unit; ValueError for another dimension, LookupError for an unknown unit."""
    source, target = unit_of(unit), unit_of(to)
    if source.dimension != target.dimension:
        raise ValueError(f"{described(source.dimension)} is not {described(target.dimension)}")
    return value if source == target else value * source.factor / target.factor


def multiplied(left: Dimension, right: Dimension) -> Dimension:
    """Return the dimension of a product."""
    return _combined(left, right, 1)


def divided(left: Dimension, right: Dimension) -> Dimension:
    """Return the dimension of a quotient."""
    return _combined(left, right, -1)


def described(dimension: Dimension) -> str:
    """Return a dimension in the symbols of units, `a plain number` for none."""
    if dimension in _NAMES:
        return _NAMES[dimension]
    above = [_power(base, exponent) for base, exponent in dimension if exponent > 0]
    below = [_power(base, -exponent) for base, exponent in dimension if exponent < 0]
    if not above and not below:
        return "a plain number"
    return "/".join(["*".join(above) or "1", *below])


def _combined(left: Dimension, right: Dimension, sign: int) -> Dimension:
    exponents = dict(left)
    for base, exponent in right:
        exponents[base] = exponents.get(base, 0) + sign * exponent
    return tuple(sorted((base, exponent) for base, exponent in exponents.items() if exponent))


def _power(base: str, exponent: int) -> str:
    return base if exponent == 1 else f"{base}^{exponent}"
