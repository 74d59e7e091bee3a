"""What changes of channels and of values that hold a name do to the nodes that launch files start."""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from kg.facts import InstanceInterface, Location, NodeInstance, Role, System
from kg.holes import fits, is_known, known_letters
from kg.impact.model import Area, Effect, Grade, Subject, launch_effect
from kg.render.text import some

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


def string_effects(systems: Sequence[System], name: str, named: str) -> Iterator[Effect]:
    """Yield the launch arguments whose default holds a name."""
    for system in systems:
        for argument in system.configuration.arguments:
            if _holds(argument.name, argument.default, name):
                what = f"the default of argument {argument.name} is {named}"
                reason = "values given for the argument keep the old name"
                yield launch_effect(system, Grade.MAY, Area.LAUNCH, what, reason, argument.location)


_FEW_LETTERS: Final = 3
"""A name of which so few letters are known fits too much."""

End: TypeAlias = "tuple[NodeInstance, InstanceInterface]"


def ends_of(system: System, kind: str, name: str) -> list[End]:
    """Return the ends of a channel in a system."""
    return [
        (instance, end)
        for instance in system.instances
        for end in instance.interfaces
        if end.resolved == name and end.declared.role.channel == kind
    ]


def partners(ends: Iterable[End], one: End) -> list[End]:
    """Return those of the ends of a channel that talk to `one`: at the other side, of another node."""
    role = one[1].declared.role.opposite
    return [other for other in ends if other[1].declared.role is role and other[0].name != one[0].name]


def end_effect(one: End, grade: Grade, reason: str, systems: Iterable[str], name: str | None = None) -> Effect:
    """Return an effect on an end in some systems; `name` is what it is called, by default its name there."""
    instance, end = one
    return Effect(
        grade,
        Area.SYSTEMS,
        f"{instance.name} {end.declared.role.verb} {name or end.resolved}",
        reason,
        end.declared.location,
        end.declared.location.repository or end.owner.repository,
        tuple(sorted(set(systems))),
        instance.started.location,
    )


@dataclass(slots=True)
class _Loss:
    """The partners that an end loses, over all systems."""

    instance: NodeInstance
    end: InstanceInterface
    certain: dict[str, None] = field(default_factory=dict)
    conditional: dict[str, str] = field(default_factory=dict)
    systems: list[str] = field(default_factory=list)
    alone: list[str] = field(default_factory=list)


def started_effects(subject: Subject, systems: Sequence[System]) -> Iterator[Effect]:
    """Yield an effect for each end of a channel: it loses its partners, or none are known; then ends that may fit."""
    losses: dict[Hashable, _Loss] = {}
    for system in systems:
        ends = ends_of(system, subject.kind, subject.name)
        for instance, end in ends:
            key = end.declared.role, instance.name, end.declared.location, end.owner
            loss = losses.setdefault(key, _Loss(instance, end))
            others = partners(ends, (instance, end))
            for other, _ in others:
                condition = instance.started.condition or other.started.condition
                if condition is None:
                    loss.certain[other.name] = None
                else:
                    loss.conditional.setdefault(other.name, condition)
            (loss.systems if others else loss.alone).append(system.configuration.name)
    for loss in losses.values():
        yield _effect(loss)
    yield from _possible(subject, systems, {end.declared.type for loss in losses.values() for end in (loss.end,)})


def _effect(loss: _Loss) -> Effect:
    if loss.certain:
        grade, reason = Grade.BREAKS, f"loses {_listed(loss.certain)}"
    elif loss.conditional:
        name, condition = next(iter(loss.conditional.items()))
        grade, reason = Grade.MAY, f"loses {_listed(loss.conditional)}; {name} is started only if {condition}"
    else:
        side = {Role.PUBLISHES: "subscribes", Role.SUBSCRIBES: "publishes"}.get(loss.end.declared.role)
        grade, reason = Grade.MAY, f"no node of the launch file {side or 'is at the other side'}; others may"
    return end_effect((loss.instance, loss.end), grade, reason, loss.systems or loss.alone, "it")


def _possible(subject: Subject, systems: Sequence[System], types: set[str | None]) -> Iterator[Effect]:
    """Yield the ends whose name is not known whole and may be that of the channel."""
    for system in systems:
        for instance in system.instances:
            for end in instance.interfaces:
                declared, name = end.declared, end.resolved
                if name is None or is_known(name) or declared.role.channel != subject.kind or declared.implicit:
                    continue
                is_like = declared.type in types and known_letters(name) > _FEW_LETTERS
                if is_like and fits(name, subject.name):
                    reason = "the name is not known whole; it may be this one"
                    yield end_effect((instance, end), Grade.MAY, reason, [system.configuration.name])


def _listed(names: Iterable[str]) -> str:
    return some(sorted(names), 4)
