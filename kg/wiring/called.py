"""Interfaces of one line of code that is run in several ways, of which the code that was read uses some."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import InstanceInterface

__all__ = ["called", "handed"]

_HOLE: Final = "{}"
_NOT_CALLED: Final = "no call of "
"""What the reason begins with where a name is an argument of a function that is not called in the code."""


def called(ends: Iterable[InstanceInterface]) -> list[InstanceInterface]:
    """Return the ends of an instance without those of unknown name that are never made, for others are in their place.

    A class with several constructors makes the same interfaces in each; the one that code calls tells their names. A
    plugin that is handed such an object has it from its node.
    """
    listed = list(ends)
    known = {_line(one) for one in listed if _is_known(one)}
    return [
        one
        for one in listed
        if _is_known(one) or not (one.reason or "").startswith(_NOT_CALLED) or _line(one) not in known
    ]


def handed(reason: str | None) -> str | None:
    """Return the argument that would tell a name, and that no call in the code gives; None for other reasons."""
    if reason is None or not reason.startswith(_NOT_CALLED):
        return None
    return reason.partition(" that gives ")[2].partition(" ")[0] or None


def _is_known(one: InstanceInterface) -> bool:
    return one.resolved is not None and _HOLE not in one.resolved


def _line(one: InstanceInterface) -> tuple[object, ...]:
    return one.declared.role, one.declared.location, one.declared.type
