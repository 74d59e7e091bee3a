"""Breaking changes between two states of the sources: places that depend on a change but did not change with it.

A place is left behind if its line is the same in both states. Lost connections in launch files follow from the ends in
both states, so a name that changed at both ends breaks nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.holes import is_known
from kg.impact.assessing import impact
from kg.impact.files import file_effects, file_mentions
from kg.impact.model import Area, DefinitionRecord, Effect, Grade, Graded, Kind, Subject, World, launch_effect, merged
from kg.impact.nodes import node_records_of
from kg.impact.parameters import same_parameter
from kg.impact.started import End, area_of, end_effect, ends_of, partners
from kg.launch.comparison import Change, Difference, Level
from kg.launch.comparison import Kind as Became
from kg.launch.comparison.report import change_words, sign

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.facts import InstanceInterface, Location, NodeInstance, NodeReference, System

_AWAY: Final = frozenset({Became.GONE, Became.RENAMED})
_LEFT: Final = {
    Kind.NODE: frozenset({Area.LAUNCH, Area.PARAMETERS, Area.PACKAGES, Area.CODE}),
    Kind.PARAMETER: frozenset({Area.CODE}),
}
"""Where effects of a node or parameter are looked for; others are found from what is started in both states."""


@dataclass(frozen=True, slots=True)
class Broken(Graded):
    """A change in `words` at a line, with what it breaks elsewhere."""

    words: str
    location: Location | None
    repository: str
    effects: tuple[Effect, ...] = ()


def broken(
    difference: Difference,
    worlds: tuple[World, World],
    systems: Sequence[tuple[System, System]],
    gone: Iterable[Subject] = (),
) -> list[Broken]:
    """Return the changes with what they break; those that break nothing have no effects.

    `worlds` are the states before and after, `systems` those that differ. `gone` are types, fields and files that the
    state after does not have.
    """
    effects_by_change: dict[Broken, list[Effect]] = {}
    lost = [one for pair in systems for one in (*_lost(*pair), *_unset(*pair, worlds[1]), *_unmatched(*pair))]
    caused: set[int] = set()
    for change in difference.at(*_SHOWN):
        side = change.after or change.before
        item = Broken(_words(change), side.location if side else None, side.repository if side else "")
        effects = effects_by_change.setdefault(item, [])
        caused.update(number for number, (loss, _) in enumerate(lost) if loss.is_due_to(change))
        effects += [effect for loss, effect in lost if loss.is_due_to(change)]
        effects += [effect for subject in _subjects(change) for effect in left_behind(subject, *worlds)]
    for number, (loss, effect) in enumerate(lost):
        if number not in caused:
            effects_by_change.setdefault(Broken(loss.words, loss.location, loss.repository), []).append(effect)
    for subject in gone:
        effects_by_change[Broken(f"- {subject.kind} {subject.text}", None, "")] = left_behind(subject, *worlds)
    return [replace(item, effects=merged(effects)) for item, effects in effects_by_change.items()]


_SHOWN: Final = frozenset(
    {Level.NODE, Level.INTERFACE, Level.PARAMETER, Level.SYSTEM, Level.ARGUMENT, Level.INSTANCE, Level.END, Level.REMAP}
)


def _words(change: Change) -> str:
    where = f" of {change.owner}" if change.level in {Level.INTERFACE, Level.PARAMETER, Level.END} else ""
    where = f" in {change.owner}" if change.level is Level.ARGUMENT else where
    return f"{sign(change)} {change_words(change)}{where}"


def _subjects(change: Change) -> Iterator[Subject]:
    """Yield what had a name before that it does not have any more."""
    if change.before is None or change.kind not in _AWAY:
        return
    name = change.before.name
    if change.level is Level.NODE:
        yield Subject(Kind.NODE, change.owner)
    elif change.level is Level.PARAMETER:
        yield Subject(Kind.PARAMETER, name, change.owner)
    elif change.level is Level.ARGUMENT:
        yield Subject(Kind.ARGUMENT, name, change.owner)
    elif change.level is Level.INSTANCE:
        yield Subject(Kind.NODE, change.owner_before or name)


def left_behind(subject: Subject, before: World, after: World) -> list[Effect]:
    """Return the effects of a change to a subject whose lines are still there, with the lines that they have now."""
    remaining = []
    if subject.kind is Kind.FILE:
        effects: Iterable[Effect] = merged([*file_effects(subject, before), *file_mentions(subject, before)])
    else:
        effects = impact(subject, before).effects
    for effect in effects:
        if effect.area not in _LEFT.get(subject.kind, frozenset(Area)) or effect.location is None:
            continue
        location = _now(effect, before, after)
        if location is not None:
            remaining.append(replace(effect, location=location))
    return remaining


def _now(effect: Effect, before: World, after: World) -> Location | None:
    """Return where the line of an effect is now, None if it changed or is gone."""
    location = effect.location
    if location is None:
        return None
    now = after.lines(effect.repository, location.path)
    if not location.line:
        return location if now else None
    lines = before.lines(effect.repository, location.path)
    if location.line > len(lines):
        return None
    text = lines[location.line - 1].strip()
    same = [number for number, line in enumerate(now, 1) if line.strip() == text]
    near = min(same, key=lambda number: abs(number - location.line), default=None)
    return None if near is None else replace(location, line=near)


@dataclass(frozen=True, slots=True)
class _Loss:
    """A name of a node that is gone: an end, or a parameter of its code, as it was before in one launch file."""

    system: str
    instance: NodeInstance
    owner: NodeReference | None
    words: str
    location: Location | None
    repository: str
    end: InstanceInterface | None = None
    parameter: str = ""

    def is_due_to(self, change: Change) -> bool:
        """Check whether a change is why the name is gone."""
        names = {side.name for side in (change.before, change.after) if side}
        if change.level in {Level.INTERFACE, Level.PARAMETER}:
            is_owner = self.owner is not None and change.owner == f"{self.owner.package}/{self.owner.node}"
            if change.level is Level.PARAMETER:
                return is_owner and any(same_parameter(self.parameter, name) for name in names)
            end = self.end.declared if self.end else None
            return is_owner and end is not None and change.role == str(end.role) and end.name in names
        before, name = change.before, change.owner_before or change.owner
        if before is None or change.system != self.system or self.end is None:
            return False
        if change.level is Level.INSTANCE:
            return (change.owner_before or before.name) == self.instance.name and change.kind in _AWAY
        return change.level is Level.END and name == self.instance.name and before.name == self.end.resolved


def _lost(before: System, after: System) -> Iterator[tuple[_Loss, Effect]]:
    """Yield the ends of a system that lost a partner without a change of their own, and the end that they lost."""
    now: Mapping[str, NodeInstance] = {one.name: one for one in after.instances}
    for instance, end, surviving in _surviving_ends(before, now):
        kind, name = end.declared.role.channel, end.resolved or ""
        had, has = (
            partners(ends_of(side, kind, name), one) for side, one in ((before, (instance, end)), (after, surviving))
        )
        left = sorted({one.name for one, _ in has})
        for other, opposite in had:
            if other.name not in left:
                yield _loss(before, (other, opposite)), _losing(after, surviving, (other, opposite), now, left)
        agreed = {one.declared.type for _, one in had} <= {end.declared.type}
        for other, opposite in has if agreed else ():
            types = surviving[1].declared.type, opposite.declared.type
            if all(types) and types[0] != types[1] and surviving[1].declared.type == end.declared.type:
                reason = f"{other.name} has type {types[1]} now, and it has {types[0]}"
                yield (
                    _loss(before, (other, opposite)),
                    end_effect(surviving, Grade.BREAKS, reason, [after.configuration.name]),
                )


def _surviving_ends(
    before: System, now: Mapping[str, NodeInstance]
) -> Iterator[tuple[NodeInstance, InstanceInterface, End]]:
    """Yield the ends with a known name of a system, each with the end that it is now."""
    for instance in before.instances:
        same = now.get(instance.name)
        for end in instance.interfaces:
            if same is None or end.resolved is None or end.declared.implicit:
                continue
            role = end.declared.role
            for one in same.interfaces:
                if one.declared.role is role and one.resolved == end.resolved:
                    yield instance, end, (same, one)
                    break


def _loss(system: System, lost: End) -> _Loss:
    instance, end = lost
    words = f"- {instance.name} {end.declared.role.verb} {end.resolved}"
    repository = instance.started.location.repository or system.configuration.repository
    return _Loss(system.configuration.name, instance, end.owner, words, instance.started.location, repository, end=end)


def _unset(before: System, after: System, world: World) -> Iterator[tuple[_Loss, Effect]]:
    """Yield the settings whose parameter the code does not have any more; `world` is the state after."""
    now = {one.name: one for one in after.instances}
    for instance in before.instances:
        declared = {one.name: one for one in instance.parameters if one.declared is not None}
        for one in now[instance.name].parameters if instance.name in now else ():
            setting = declared.get(one.name)
            if one.declared is not None or setting is None or setting.declared is None:
                continue
            what = f"sets {one.name.removeprefix(f'{instance.name}/')} of {instance.name.rpartition('/')[2]}"
            reason = "the code does not have the parameter any more"
            name, grade = setting.declared.name or "", Grade.BREAKS
            if now[instance.name].type is None or _is_partial(setting.owner, world):
                grade, reason = Grade.MAY, "the code is not known to have the parameter any more"
            effect = launch_effect(after, grade, area_of(one.set.location), what, reason, one.set.location)
            words = f"- parameter {name} of {instance.name}"
            yield _Loss(after.configuration.name, instance, setting.owner, words, None, "", parameter=name), effect


def _is_partial(owner: NodeReference | None, world: World) -> bool:
    """Check whether a parameter of a node type may have a name that is not known."""
    if owner is None:
        return False
    return any(
        one.node.bounds or not all(is_known(parameter.name) for parameter in one.node.parameters)
        for one in node_records_of(Subject(Kind.NODE, f"{owner.package}/{owner.node}"), world)
        if one.repository == owner.repository
    )


def _unmatched(before: System, after: System) -> Iterator[tuple[_Loss, Effect]]:
    """Yield the remappings that renamed something before, and rename nothing now."""
    now = {one.name: one for one in after.instances}
    for instance in before.instances:
        used = {one.source: one for one in instance.remaps if one.used}
        for one in now[instance.name].remaps if instance.name in now else ():
            if one.used or one.source not in used:
                continue
            end = next((end for end in instance.interfaces if end.remap == used[one.source].remap), None)
            what = f"{instance.name} remaps {one.source} to {one.target}"
            reason = "no name of the node matches it any more"
            effect = launch_effect(after, Grade.BREAKS, Area.LAUNCH, what, reason, one.remap.location)
            owner = end.owner if end else instance.type
            words = f"- {instance.name} has no {one.source}"
            yield _Loss(after.configuration.name, instance, owner, words, None, "", end=end), effect


def _losing(system: System, end: End, lost: End, now: Mapping[str, NodeInstance], left: list[str]) -> Effect:
    other, opposite = lost
    still = now.get(other.name)
    reason, condition = f"loses {other.name}", end[0].started.condition or other.started.condition
    unknown = still is not None and (
        still.type is None
        or any(one.declared.role is opposite.declared.role and not is_known(one.resolved) for one in still.interfaces)
    )
    grade = Grade.MAY
    if left:
        reason = f"{reason}; {', '.join(left[:3])} remain{'s' if len(left) == 1 else ''}"
    elif condition is not None:
        reason = f"{reason}, if {condition}"
    elif unknown:
        reason = f"{reason}, unless a name of it that is not known is this one"
    elif still is None and end[1].declared.role.gives:
        reason = f"{reason}; nothing else uses it"
    else:
        grade, reason = Grade.BREAKS, f"{reason} and has no other peer"
    return end_effect(end, grade, reason, [system.configuration.name])


def definition_changes(before: Sequence[DefinitionRecord], after: Sequence[DefinitionRecord]) -> list[Subject]:
    """Return the types that are gone, and the fields that are gone or have another type."""
    now = {(one.repository, one.definition.kind, one.name): one for one in after}
    subjects = []
    for one in before:
        other = now.get((one.repository, one.definition.kind, one.name))
        if other is None:
            subjects.append(Subject(Kind.TYPE, one.name))
            continue
        fields = {(each.section, each.name, each.type) for each in other.definition.fields}
        subjects += [
            Subject(Kind.FIELD, each.name, one.name)
            for each in one.definition.fields
            if (each.section, each.name, each.type) not in fields
        ]
    return subjects
