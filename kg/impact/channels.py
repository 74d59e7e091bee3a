"""What a topic, service or action is named by, and who uses it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.facts import Interface, LaunchParameter, NodeInstance, NodeReference, Remap, System
from kg.impact.model import Area, Effect, Grade, Subject, World, launch_effect
from kg.impact.started import End, ends_of, partners, started_effects
from kg.impact.values import area_of, argument_effects, holding_effects

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Sequence


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
    yield from argument_effects(systems, subject.name, named)
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
