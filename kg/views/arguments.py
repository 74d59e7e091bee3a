"""Arguments of views, which come as texts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import msgspec

from kg.errors import UsageError

_DIGITS: Final = 9  # how many digits a number may have: any with so many fits wherever it goes


def whole(text: str, otherwise: int) -> int:
    """Return the whole number that a text is, from zero; `otherwise` for any other text."""
    return int(text) if text.isascii() and text.isdigit() and len(text) <= _DIGITS else otherwise


def texts(given: str | Mapping[str, str], what: str) -> Mapping[str, str]:
    """Return texts by name, which may be given as a JSON object; UsageError KG003 where `what` is not one."""
    if not isinstance(given, str):
        return given
    try:
        return msgspec.json.decode(given or "{}", type=dict[str, str])
    except msgspec.DecodeError as error:
        hint = 'Write {"NAME": "VALUE"}.'
        raise UsageError("KG003", f"the {what} is not a JSON object of strings: {error}", hint=hint) from None
