"""The impact of a change to one subject; that of topics, services and actions is assessed here."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import Final

from kg.facts import Interface, LaunchParameter, NodeInstance, NodeReference, Remap, System
from kg.impact.files import (
    HOLDING,
    absolute_name,
    argument_about,
    argument_effects,
    declared_subjects,
    file_about,
    file_effects,
    file_mentions,
    mentions,
)
from kg.impact.model import CHANNELS, Area, Effect, Grade, Impact, Kind, Subject, World, launch_effect, merged
from kg.impact.nodes import node_about, node_effects
from kg.impact.parameters import declared_settings, parameter_about, parameter_effects
from kg.impact.started import End, area_of, ends_of, holding_effects, partners, started_effects, string_effects
from kg.impact.types import field_mentions, type_about, type_effects, type_mentions


def channel_effects(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield what depends on the name of a channel."""
    systems = world.systems(subject)
    yield from started_effects(subject, systems)
    for system in systems:
        ends = ends_of(system, subject.kind, subject.name)
        for instance in system.instances:
            yield from _remaps(subject, system, instance, ends)
            yield from _settings(system, instance, ends)
    named = f"the name of the {subject.kind}"
    yield from holding_effects(systems, subject.name, named)
    yield from string_effects(systems, subject.name, named)
    yield from _code(subject, world, systems)


def channel_about(subject: Subject, world: World) -> list[str]:
    """Return the types of a channel, and in how many launch files it exists."""
    systems = [one for one in world.systems(subject) if ends_of(one, subject.kind, subject.name)]
    ends = [end for one in systems for _, end in ends_of(one, subject.kind, subject.name)]
    declared = [one.declared for one in ends] + [one for _, one in _declared(subject, world)]
    types = sorted({one.type for one in declared if one.type})
    return [*types, *([f"in {len(systems)} launch files"] if len(systems) > 1 else [])]


def _declared(subject: Subject, world: World) -> Iterator[tuple[NodeReference, Interface]]:
    for record in world.nodes(subject):
        owner = NodeReference(record.repository, record.package, record.node.name)
        for end in record.node.interfaces:
            if end.role.channel == subject.kind and end.resolved == subject.name:
                yield owner, end


def _remaps(subject: Subject, system: System, instance: NodeInstance, ends: list[End]) -> Iterator[Effect]:
    for one in instance.remaps:
        own = [pair for pair in ends if pair[0] is instance and pair[1].remap == one.remap]
        if one.source == subject.name and one.target != subject.name and _role_fits(subject, instance, one.remap):
            code = instance.type.node if instance.type else instance.name
            grade, reason = Grade.MAY, f"matches nothing once the code of {code} has another name"
            what = f"{instance.name} remaps it to {one.target}"
        elif one.target == subject.name and own:
            left = _left(ends, own, one.remap)
            grade = Grade.BREAKS if left else Grade.MAY
            reason = f"still gives the old name{', which would separate it from ' + left if left else ''}"
            what = f"{instance.name} gets the name by a remapping of {one.source}"
        else:
            continue
        yield launch_effect(system, grade, Area.LAUNCH, what, reason, one.remap.location)


def _role_fits(subject: Subject, instance: NodeInstance, remap: Remap) -> bool:
    """Check whether a remapping renames an end of the kind of the subject."""
    return any(end.remap == remap and end.declared.role.channel == subject.kind for end in instance.interfaces)


def _left(ends: list[End], own: list[End], cause: Remap | LaunchParameter) -> str:
    """Return the nodes at the other side of `own` that have the name for another reason than `cause`."""
    names = {
        other.name
        for one in own
        for other, end in partners(ends, one)
        if cause.location not in {each.location for each in (end.remap, end.parameter) if each}
    }
    return ", ".join(sorted(names))


def _settings(system: System, instance: NodeInstance, ends: list[End]) -> Iterator[Effect]:
    for owner, end in ends:
        if owner is not instance or end.parameter is None:
            continue
        setting = end.parameter
        left = _left(ends, [(owner, end)], setting)
        yield launch_effect(
            system,
            Grade.BREAKS if left else Grade.MAY,
            area_of(setting.location),
            f"{instance.name} gets the name from its parameter {setting.name.removeprefix(f'{instance.name}/')}",
            f"still gives the old name{', which would separate it from ' + left if left else ''}",
            setting.location,
        )


def _code(subject: Subject, world: World, systems: Sequence[System]) -> Iterator[Effect]:
    """Yield the ends that have the name when their node is started alone, except those that launch files show."""
    shown: set[Hashable] = {
        (end.owner, end.declared.role, end.declared.location)
        for system in systems
        for _, end in ends_of(system, subject.kind, subject.name)
    }
    declared = list(_declared(subject, world))
    for owner, end in declared:
        if (owner, end.role, end.location) in shown:
            continue
        others = sorted({f"{one.package}/{one.node}" for one, other in declared if other.role is end.role.opposite})
        reason = f"talks to {', '.join(others[:4])} if both are started without remapping" if others else ""
        yield Effect(
            Grade.MAY,
            Area.CODE,
            f"{owner.package}/{owner.node} {end.role.verb} it",
            reason or "no partner of this name is known; something outside the sources may be one",
            end.location,
            end.location.repository or owner.repository,
        )


_EFFECTS: Final[dict[Kind, Callable[[Subject, World], Iterator[Effect]]]] = {
    **dict.fromkeys(CHANNELS, channel_effects),
    Kind.TYPE: type_effects,
    Kind.FIELD: type_effects,
    Kind.PARAMETER: parameter_effects,
    Kind.NODE: node_effects,
    Kind.ARGUMENT: argument_effects,
    Kind.FILE: file_effects,
}
_ABOUT: Final[dict[Kind, Callable[[Subject, World], list[str]]]] = {
    **dict.fromkeys(CHANNELS, channel_about),
    Kind.TYPE: type_about,
    Kind.FIELD: type_about,
    Kind.PARAMETER: parameter_about,
    Kind.NODE: node_about,
    Kind.ARGUMENT: argument_about,
    Kind.FILE: file_about,
}


def impact(subject: Subject, world: World) -> Impact:
    """Return what breaks or may break if a subject is renamed, removed or changed.

    A line that no fact covers, but whose text names the subject, is among the effects that may break.
    """
    subjects = [subject, *(declared_subjects(subject, world) if subject.kind is Kind.FILE else ())]
    stated = merged(effect for one in subjects for effect in _EFFECTS[one.kind](one, world))
    covered = {(one.repository, one.location) for one in stated}
    if subject.kind is Kind.PARAMETER:
        covered |= set(declared_settings(subject, world))
    texts = (effect for one in subjects for effect in _mentions(one, world))
    effects = merged([*stated, *(one for one in texts if (one.repository, one.location) not in covered)])
    return Impact(subject, tuple(_ABOUT[subject.kind](subject, world)), effects)


def _mentions(subject: Subject, world: World) -> Iterable[Effect]:
    if subject.kind in CHANNELS:
        files = (file for file in world.files if file.kind in HOLDING)
        pattern = absolute_name(subject.name)
        return mentions(world, files, [subject.name], pattern, f"holds the name of the {subject.kind}")
    if subject.kind is Kind.TYPE:
        return type_mentions(subject, world)
    if subject.kind is Kind.FIELD:
        return field_mentions(subject, world)
    if subject.kind is Kind.PARAMETER:
        name = subject.name.rpartition(".")[2].removeprefix("~/")
        key = re.compile(rf"^\s*(?:\S*[./])?{re.escape(name)}\s*:(?!=)")
        files = (file for file in world.files if file.kind in HOLDING)
        return mentions(world, files, [name], key, "a key of this name; whether it is for this node is not known")
    if subject.kind is Kind.FILE:
        return file_mentions(subject, world)
    return ()
