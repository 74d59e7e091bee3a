"""Parsing of numbers in options: commands receive texts."""

from __future__ import annotations

from typing import Final

from kg.errors import UsageError


def whole(text: str, option: str, least: int, most: int | None = None) -> int:
    """Return the integer of `option`; UsageError KG003 if it is invalid or out of bounds."""
    bounds = f"at least {least}" if most is None else f"from {least} to {most}"
    try:
        number = int(text)
    except ValueError:
        number = least - 1
    if number < least or (most is not None and number > most):
        raise UsageError(
            "KG003", f"`{option} {text}` is not a whole number {bounds}", hint="See the command's `--help`."
        )
    return number


def seconds(text: str, option: str) -> float:
    """Return the seconds of `option`; UsageError KG003 below 1 ms, or if it is invalid."""
    return _positive(text, option, "number of seconds", "Write 30 or 0.5.", 0.001)  # no timer is finer


def frequency(text: str, option: str) -> float:
    """Return the frequency of `option` in Hz; UsageError KG003 unless it is a positive number."""
    return _positive(text, option, "rate", "Write 10 or 0.5: so many times a second.")


def factor(text: str, option: str) -> float:
    """Return the factor of `option`; UsageError KG003 unless it is a positive number."""
    return _positive(text, option, "factor", "Write 2 or 0.5: so many times as much.")


def _positive(text: str, option: str, what: str, hint: str, least: float = 0.0) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if number == 0 or not least <= number < float("inf"):
        raise UsageError("KG003", f"`{option} {text}` is not a {what}", hint=hint)
    return number


_UNITS: Final = {"k": 10, "m": 20, "g": 30}


def size(text: str, option: str) -> int:
    """Return the number of bytes of `option` (`800`, `500K`, `4M`, `1G`); UsageError KG003 if it is invalid."""
    unit = _UNITS.get(text[-1:].lower())
    digits = text[:-1] if unit else text
    if not digits.isdecimal() or not int(digits):
        raise UsageError("KG003", f"`{option} {text}` is not a size", hint="Write bytes, or 500K, 4M, 1G.")
    return int(digits) << (unit or 0)
