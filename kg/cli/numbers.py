"""Numbers that a user types: commands get texts, and read them here."""

from __future__ import annotations

from typing import Final

from kg.errors import UsageError


def whole(text: str, option: str, least: int, most: int | None = None) -> int:
    """Return the number that the text behind `option` is; UsageError KG003 when it is none, or out of bounds."""
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
    """Return the seconds that the text behind `option` says; UsageError KG003 below 1 ms, and for no number."""
    return _positive(text, option, "number of seconds", "Write 30 or 0.5.", 0.001)  # no timer is finer


def frequency(text: str, option: str) -> float:
    """Return how often a second the text behind `option` says; UsageError KG003 for no number above zero."""
    return _positive(text, option, "rate", "Write 10 or 0.5: so many times a second.")


def factor(text: str, option: str) -> float:
    """Return how many times as much the text behind `option` says; UsageError KG003 for no number above zero."""
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
    """Return the bytes that the text behind `option` (`800`, `500K`, `4M`, `1G`) is; UsageError KG003 for another."""
    unit = _UNITS.get(text[-1:].lower())
    digits = text[:-1] if unit else text
    if not digits.isdecimal() or not int(digits):
        raise UsageError("KG003", f"`{option} {text}` is not a size", hint="Write bytes, or 500K, 4M, 1G.")
    return int(digits) << (unit or 0)
