"""Numbers that a user types: commands get texts, and read them here."""

from __future__ import annotations

from typing import Final

from kg.errors import UsageError

__all__ = ["size", "whole"]


def whole(text: str, option: str, least: int, most: int | None = None) -> int:
    """Return the number that the text behind `option` is; UsageError KG003 when it is none, or out of bounds."""
    bounds = f"at least {least}" if most is None else f"from {least} to {most}"
    try:
        number = int(text)
    except ValueError:
        number = least - 1
    if number < least or (most is not None and number > most):
        raise UsageError("KG003", f"`{option} {text}` is no whole number {bounds}", hint="See the command's `--help`.")
    return number


_UNITS: Final = {"k": 10, "m": 20, "g": 30}


def size(text: str, option: str) -> int:
    """Return the bytes that the text behind `option` (`800`, `500K`, `4M`, `1G`) is; UsageError KG003 for another."""
    unit = _UNITS.get(text[-1:].lower())
    digits = text[:-1] if unit else text
    if not digits.isdecimal() or not int(digits):
        raise UsageError("KG003", f"`{option} {text}` is no size", hint="Write bytes, or 500K, 4M, 1G.")
    return int(digits) << (unit or 0)
