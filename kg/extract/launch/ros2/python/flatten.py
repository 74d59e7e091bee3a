"""From values to actions: lists in lists, descriptions, choices; what cannot be known is said."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.launch.expressions.texts import reason_of
from kg.extract.launch.expressions.values import Choice, Guarded, Items, Unknown
from kg.extract.launch.ros2.actions import Action, Group
from kg.extract.launch.ros2.python.values import Description, Ignored, Source

if TYPE_CHECKING:
    from kg.extract.launch.expressions.values import Condition, Value
    from kg.extract.launch.ros2.python.machine import Machine
    from kg.facts import Location

__all__ = ["actions_of", "under"]

_MAX_DEPTH = 100


def actions_of(machine: Machine, value: Value, location: Location, depth: int = 0) -> list[Action]:
    """Return the actions that a value stands for; `location` is where it is used."""
    machine.step()
    if value is None or isinstance(value, Ignored):
        return []
    if isinstance(value, Action):
        return [value]
    if depth > _MAX_DEPTH:
        machine.unresolved("actions are nested too deeply", location)
        return []
    if isinstance(value, Description):
        return actions_of(machine, value.entities, location, depth + 1)
    if isinstance(value, Items | tuple):
        return [action for item in value for action in actions_of(machine, item, location, depth + 1)]
    if isinstance(value, Guarded):
        return under(value.condition, actions_of(machine, value.value, location, depth + 1))
    if isinstance(value, Choice):
        found: list[Action] = []
        for condition, option in value.options:
            inner = actions_of(machine, option, location, depth + 1)
            found += inner if condition is None else under(condition, inner)
        return found
    why = value.reason if isinstance(value, Unknown) else reason_of(value)
    if not isinstance(value, Source):
        place = value.place if isinstance(value, Unknown) and value.place else location
        machine.unresolved(f"an action is not known: {why}", place)
    return []


def under(condition: Condition, actions: list[Action]) -> list[Action]:
    """Return actions as a group that stands under a condition."""
    if not actions:
        return []
    return [Group(location=actions[0].location, condition=condition, actions=tuple(actions), scoped=False)]
