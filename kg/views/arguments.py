"""Arguments of views, which come as texts."""

from __future__ import annotations

from typing import Final

_DIGITS: Final = 9  # how many digits a number may have: any with so many fits wherever it goes


def whole(text: str, otherwise: int) -> int:
    """Return the whole number that a text is, from zero; `otherwise` for any other text."""
    return int(text) if text.isascii() and text.isdigit() and len(text) <= _DIGITS else otherwise
