"""Conditions under which a node creates an interface, in words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from kg.facts import HOLDS, Switch

_SIGNS: Final = {"==": "is"}


def condition(switches: Iterable[str]) -> str:
    """Return what decides whether an interface exists: `if use_imu and mode is scan, unless a.cpp:7 holds`."""
    parsed = [Switch.parse(one) for one in switches]
    chosen = {one.parameter for one in parsed if one.wanted and one.sign == "=="}
    words = []
    for word, wanted in (("if", True), ("unless", False)):
        named = [
            _named(one) if one.value is None else f"{one.parameter} {_SIGNS.get(one.sign, one.sign)} {one.value}"
            for one in parsed
            # That a parameter has one value says that it has no other.
            if one.wanted is wanted and (wanted or one.sign != "==" or one.parameter not in chosen)
        ]
        words += [f"{word} {(' and ' if wanted else ' or ').join(named)}"] if named else []
    return ", ".join(words)


def _named(switch: Switch) -> str:
    """Return a switch without a value: a parameter, or the place of a condition in the code, without folders."""
    return f"{switch.parameter.rpartition('/')[2]} {HOLDS}" if switch.sign == HOLDS else switch.parameter
