"""What a parameter is read by, set by, and what it names."""

from __future__ import annotations

import re
from collections import defaultdict
from itertools import product
from typing import TYPE_CHECKING, Final

from kg.facts import InstanceParameter, Location, NodeInstance, Switch, System
from kg.holes import is_partial, known_letters, pattern
from kg.impact.model import Effect, Grade, Subject, World, code_effect, launch_effect
from kg.impact.started import area_of, end_effect, ends_of, partners
from kg.names import normalise

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.launch.comparison.changes import Record

_VERBS: Final = {"read": "reads", "write": "writes", "declare": "declares"}
_MOST_SIGNS: Final = 8
"""The parts of a name that has more signs between them are all parted by the same sign."""


def same_parameter(one: str | None, other: str) -> bool:
    """Check whether two names as nodes give them mean one parameter: `~/rate`, `~rate` and `rate`."""
    return one is not None and _bare(one) == _bare(other)


def spellings(name: str) -> set[str]:
    """Return the names, as code spells them, that mean the same parameter as `name`."""
    bare = _bare(name)
    parts = bare.split(".")
    number = len(parts) - 1
    signs = product("./", repeat=number) if number <= _MOST_SIGNS else [("." * number), ("/" * number)]
    spelled = {"".join(map(str.__add__, parts, (*one, ""))) for one in signs}
    return {name, *(f"{front}{one}" for one in spelled for front in ("", "~", "~/"))}


def _bare(name: str) -> str:
    return normalise(name).removeprefix("~/").removeprefix("~").replace("/", ".")


def names_node(record: Record, name: str) -> bool:
    """Check whether `name` (`node` or `package/node`) means a node type."""
    return name in {record.node.name, f"{record.package}/{record.node.name}", record.node.node_name}


def has_parameter(record: Record, subject: Subject) -> bool:
    """Check whether a node type has the parameter that is meant."""
    return (not subject.owner or names_node(record, subject.owner)) and bool(_meant(record, subject.name))


def _meant(record: Record, name: str) -> set[str]:
    """Return the parameter of a node type that a name means, without `~/`: the one with it, else its closest family.

    `odom0` is one of the family `odom{}`, but `odom0_config` of `odom{}_config`.
    """
    own = {_bare(one.name) for one in record.node.parameters if one.name}
    bare = _bare(name)
    if bare in own:
        return {bare}
    families = [one for one in own if is_partial(one) and pattern(one).fullmatch(bare)]
    closest = max(map(known_letters, families), default=0)
    return {one for one in families if known_letters(one) == closest}


def _owned(subject: Subject, world: World) -> Iterator[tuple[Record, set[str]]]:
    """Yield the node types that have the parameter that is meant, each with the names that mean it there."""
    for record in world.nodes(subject):
        if has_parameter(record, subject):
            yield record, _meant(record, subject.name)


def parameter_about(subject: Subject, world: World) -> list[str]:
    """Return the types and defaults of a parameter."""
    declared = [
        one
        for record, meant in _owned(subject, world)
        for one in record.node.parameters
        if one.name and _bare(one.name) in meant
    ]
    types = sorted({one.type for one in declared if one.type})
    return [*types, *(f"default {one}" for one in sorted({one.default for one in declared if one.default is not None}))]


def parameter_effects(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield what depends on the name of a parameter: code, what sets it, and the channels that it names or enables."""
    for record, meant in _owned(subject, world):
        yield from _code(record, meant)
    for system in world.systems(subject):
        for instance in system.instances:
            yield from _started(subject, system, instance)


def _code(record: Record, meant: set[str]) -> Iterator[Effect]:
    node = f"{record.package}/{record.node.name}"

    def is_meant(name: str | None) -> bool:
        return name is not None and _bare(name) in meant

    for one in record.node.parameters:
        if is_meant(one.name):
            what = f"{node} {_VERBS[str(one.access)]} it"
            yield code_effect(record, Grade.BREAKS, what, "the code names the parameter", one.location)
    for end in record.node.interfaces:
        named = is_meant(end.parameter)
        if named or any(is_meant(Switch.parse(one).parameter) for one in end.switches):
            what = f"{node} {end.role.verb} {end.name or '?'}"
            reason = "the parameter gives the name" if named else "the parameter enables it"
            yield code_effect(record, Grade.MAY, what, reason, end.location)
    for slot in record.node.slots:
        if is_meant(slot.names) or is_meant(slot.parameter):
            what = f"{node} loads plugins of {slot.base_class or 'a class that is not known'}"
            yield code_effect(record, Grade.BREAKS, what, "the parameter names the plugins", slot.location)


def _started(subject: Subject, system: System, instance: NodeInstance) -> Iterator[Effect]:
    set_by: defaultdict[object, list[InstanceParameter]] = defaultdict(list)
    for one in instance.parameters:
        effect = _setting(subject, system, instance, one)
        if effect is not None:
            yield effect
            set_by[one.set].append(one)
    for end in instance.interfaces:
        if end.parameter is None or end.parameter not in set_by or end.resolved is None:
            continue
        others = partners(ends_of(system, end.declared.role.channel, end.resolved), (instance, end))
        lost = ", ".join(sorted({other.name for other, _ in others}))
        grade = Grade.BREAKS if lost else Grade.MAY
        reason = (
            f"the parameter gives the name; with another it loses {lost}" if lost else "the parameter gives the name"
        )
        yield end_effect((instance, end), grade, reason, [system.configuration.name])


def declared_settings(subject: Subject, world: World) -> Iterator[tuple[str, Location]]:
    """Yield the lines, with their sources, of settings whose parameter is known."""
    for system in world.systems(subject):
        for instance in system.instances:
            for one in instance.parameters:
                if one.declared is not None:
                    yield one.set.location.repository or system.configuration.repository, one.set.location


def _setting(subject: Subject, system: System, instance: NodeInstance, one: InstanceParameter) -> Effect | None:
    """Return the effect on what sets a parameter, None if it sets another one."""
    inner = one.name.removeprefix(f"{instance.name}/")
    owner = one.owner or instance.type
    is_owner = not subject.owner or (
        subject.owner in {instance.name, f"{owner.package}/{owner.node}", owner.node} if owner else False
    )
    certain = one.declared is not None
    if one.declared is not None:
        is_member = one.declared.name is not None and is_partial(one.declared.name)
        is_same = same_parameter(inner if is_member else one.declared.name, subject.name)
        is_same |= is_member and same_parameter(one.declared.name, subject.name)
    else:
        is_same = re.search(rf"(?:^|[./]){re.escape(_bare(subject.name))}$", inner) is not None
    if not (is_same and is_owner):
        return None
    value = f" to {one.set.value}" if one.set.value is not None else ""
    return launch_effect(
        system,
        Grade.BREAKS if certain else Grade.MAY,
        area_of(one.set.location),
        f"sets {inner} of {instance.name.rpartition('/')[2]}{value}",
        "the key would set nothing" if certain else "no code is known to read the key",
        one.set.location,
    )
