"""What relies on a node: launch files that start it, partners on its channels, and what loads, hosts or lists it."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.facts import InstanceInterface, Location, NodeInstance, NodeReference, System
from kg.holes import is_known
from kg.impact.model import Area, Effect, Grade, Subject, World, code_effect, launch_effect
from kg.impact.started import area_of, elements, end_effect, ends_of, partners
from kg.render.text import count

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.launch.comparison.changes import Record

_LISTS: Final = "node_names"
"""The parameter in which a lifecycle manager lists the nodes that it manages."""


def node_records_of(subject: Subject, world: World) -> list[Record]:
    """Return the node types that a subject means; none for a started node."""
    return [one for one in world.nodes(subject) if f"{one.package}/{one.node.name}" == subject.name]


def node_about(subject: Subject, world: World) -> list[str]:
    """Return the kind of a node and where it is declared."""
    records = node_records_of(subject, world)
    if records:
        return [f"{one.node.kind} at {one.node.location}" for one in records]
    systems = world.systems(subject)
    types = {one.started_type for system in systems for one in system.instances if one.name == subject.name}
    return [f"started as {', '.join(sorted(types))}"] if types else []


def node_effects(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield what relies on a node type, or on a started node."""
    records = node_records_of(subject, world)
    references = {NodeReference(one.repository, one.package, one.node.name) for one in records}
    for record in records:
        node, name = record.node, f"{record.package}/{record.node.name}"
        if node.exported is not None:
            repository = node.exported.repository or record.repository
            what = f"registers {node.plugin or name}"
            yield Effect(Grade.BREAKS, Area.PACKAGES, what, "names the class of the node", node.exported, repository)
    yield from _defaults(references, world.nodes(subject))
    for system in world.systems(subject):
        own = [one for one in system.instances if one.name == subject.name or one.type in references]
        for instance in own:
            yield _start(system, instance)
            yield from _hosted(system, instance)
        yield from _keys(system, own)
        names = {one.name for one in own} | {subject.name}
        for instance in system.instances:
            if references.intersection(instance.plugins):
                yield _loads(system, instance, subject)
            yield from _lists(system, instance, {one for one in names if one.startswith("/")})
        yield from _alone(system, own)


def _start(system: System, instance: NodeInstance) -> Effect:
    started = instance.started
    others = len([one for one in instance.remaps if one.used])
    along = f" with {count(others, 'remapping')}" if others else ""
    reason = "starts it" if started.condition is None else f"starts it if {started.condition}"
    return launch_effect(system, Grade.BREAKS, Area.LAUNCH, f"starts {instance.name}{along}", reason, started.location)


def _hosted(system: System, host: NodeInstance) -> Iterator[Effect]:
    for one in system.instances:
        if one.host == host.name:
            what = f"{one.name} is loaded into {host.name}"
            yield launch_effect(
                system, Grade.BREAKS, Area.SYSTEMS, what, "has no process without it", one.started.location
            )


def _keys(system: System, own: Sequence[NodeInstance]) -> Iterator[Effect]:
    """Yield the parameters of a file below the name of a node, one effect for each file."""
    for instance in own:
        by_file: defaultdict[Location, list[Location]] = defaultdict(list)
        for one in instance.parameters:
            location = one.set.location
            if area_of(location) is Area.PARAMETERS:
                by_file[Location(location.path, 0, location.repository)].append(location)
        for file, locations in by_file.items():
            first = min(locations, key=lambda one: one.line)
            what = f"{file.path} sets parameters of {instance.name}"
            reason = "a key that names the node would match nothing if it is renamed"
            yield launch_effect(system, Grade.MAY, Area.PARAMETERS, what, reason, first)


def _loads(system: System, instance: NodeInstance, subject: Subject) -> Effect:
    what = f"{instance.name} loads {subject.name}"
    return launch_effect(
        system, Grade.BREAKS, Area.SYSTEMS, what, "its parameters name the plugin", instance.started.location
    )


def _lists(system: System, instance: NodeInstance, names: set[str]) -> Iterator[Effect]:
    for one in instance.parameters:
        inner = one.name.rpartition("/")[2]
        listed = elements(one.set.value)
        for name in sorted(names):
            last = name.rpartition("/")[2]
            if instance.name == name or not (
                {name, name[1:]}.intersection(listed) or (inner == _LISTS and last in listed)
            ):
                continue
            certain = inner == _LISTS
            yield launch_effect(
                system,
                Grade.BREAKS if certain else Grade.MAY,
                area_of(one.set.location),
                f"{inner} of {instance.name} {'lists' if certain else 'holds'} {last}",
                "would wait for a node that is not there" if certain else "how the node uses the value is not known",
                one.set.location,
            )


def _alone(system: System, own: Sequence[NodeInstance]) -> Iterator[Effect]:
    """Yield the ends of other nodes that talk to a node, with who is left at the other side without it."""
    gone = {one.name for one in own}
    seen: set[tuple[str, object]] = set()
    for instance in own:
        for end in instance.interfaces:
            if end.declared.implicit or not is_known(end.resolved):
                continue
            ends = ends_of(system, end.declared.role.channel, end.resolved)
            for other, opposite in partners(ends, (instance, end)):
                key = other.name, (opposite.declared.role, opposite.resolved, opposite.declared.location)
                if other.name in gone or key in seen:
                    continue
                seen.add(key)
                left = sorted({one.name for one, _ in partners(ends, (other, opposite))} - gone)
                yield _partner(system, instance, other, opposite, left)


def _partner(
    system: System, instance: NodeInstance, other: NodeInstance, end: InstanceInterface, left: list[str]
) -> Effect:
    condition = instance.started.condition or other.started.condition
    if end.declared.role.gives:
        grade, reason = Grade.MAY, f"loses {instance.name}{'' if left else '; nothing else uses it'}"
    elif left:
        grade, reason = Grade.MAY, f"loses {instance.name}; {', '.join(left[:3])} remain{'s' if len(left) == 1 else ''}"
    elif condition is not None:
        grade, reason = Grade.MAY, f"has no other peer, if {condition}"
    else:
        grade, reason = Grade.BREAKS, f"loses {instance.name} and has no other peer"
    return end_effect((other, end), grade, reason, [system.configuration.name])


def _defaults(references: set[NodeReference], nodes: Sequence[Record]) -> Iterator[Effect]:
    """Yield the node types that load a plugin unless parameters say otherwise."""
    plugins = {
        one.node.plugin: f"{one.package}/{one.node.name}"
        for one in nodes
        if one.node.plugin and NodeReference(one.repository, one.package, one.node.name) in references
    }
    spelled = {plugin.replace("/", "::"): name for plugin, name in plugins.items()}
    for record in nodes:
        for slot in record.node.slots:
            for default in slot.defaults:
                name = spelled.get(default.class_name.replace("/", "::"))
                if name is not None:
                    what = f"{record.package}/{record.node.name} loads {name} by default"
                    reason = "breaks unless parameters name other plugins"
                    yield code_effect(record, Grade.MAY, what, reason, slot.location)
