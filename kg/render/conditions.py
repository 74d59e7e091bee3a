"""Conditions under which a node creates an interface, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.facts import Switch

if TYPE_CHECKING:
    from collections.abc import Iterable

_SIGNS: Final = {"==": "is"}


def condition(switches: Iterable[str]) -> str:
    """Return the parameters that decide whether an interface exists: `if use_imu and mode is scan, unless quiet`."""
    parsed = [Switch.parse(one) for one in switches]
    chosen = {one.parameter for one in parsed if one.wanted and one.sign == "=="}
    words = []
    for word, wanted in (("if", True), ("unless", False)):
        named = [
            one.parameter if one.value is None else f"{one.parameter} {_SIGNS.get(one.sign, one.sign)} {one.value}"
            for one in parsed
            # That a parameter has one value says that it has no other.
            if one.wanted is wanted and (wanted or one.sign != "==" or one.parameter not in chosen)
        ]
        words += [f"{word} {(' and ' if wanted else ' or ').join(named)}"] if named else []
    return ", ".join(words)
