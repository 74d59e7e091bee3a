"""Numbers that a user types: commands get texts, and read them here."""

from __future__ import annotations

from kg.errors import UsageError

__all__ = ["whole"]


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
