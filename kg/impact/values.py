"""Values of parameters and arguments that hold a name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.impact.model import Area, Effect, Grade, launch_effect

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.facts import Location, System

_NAMING: Final = re.compile(r"topic|service|action|server|channel|frame", re.IGNORECASE)
"""Parameters with such names may hold relative names."""
_TOKEN: Final = re.compile(r"[^\s,\[\]{}\"']+")


def elements(value: str | None) -> list[str]:
    """Return the texts in a value that is written as YAML in one line."""
    return [token.rstrip(":") for token in _TOKEN.findall(value)] if value else []


def area_of(location: Location) -> Area:
    """Return where a setting is read: a parameter file or a launch file."""
    name = location.path.rpartition("/")[2]
    is_file = name.endswith((".yaml", ".yml")) and "launch" not in name
    return Area.PARAMETERS if is_file else Area.LAUNCH


def _holds(key: str, value: str | None, name: str) -> bool:
    parts = elements(value)
    return name in parts or (bool(_NAMING.search(key)) and name.lstrip("/") in parts)


def holding_effects(systems: Sequence[System], name: str, named: str) -> Iterator[Effect]:
    """Yield the settings whose value holds a name, except those that are known to name an end; `named` says what."""
    for system in systems:
        for instance in system.instances:
            naming = {end.parameter for end in instance.interfaces if end.parameter is not None}
            for one in instance.parameters:
                if one.set not in naming and _holds(one.name, one.set.value, name):
                    what = f"{one.name.removeprefix(f'{instance.name}/')} of {instance.name} holds {named}"
                    reason, location = "how the node uses the value is not known", one.set.location
                    yield launch_effect(system, Grade.MAY, area_of(location), what, reason, location)


def argument_effects(systems: Sequence[System], name: str, named: str) -> Iterator[Effect]:
    """Yield the launch arguments whose default holds a name."""
    for system in systems:
        for argument in system.configuration.arguments:
            if _holds(argument.name, argument.default, name):
                what = f"the default of argument {argument.name} is {named}"
                reason = "values given for the argument keep the old name"
                yield launch_effect(system, Grade.MAY, Area.LAUNCH, what, reason, argument.location)
