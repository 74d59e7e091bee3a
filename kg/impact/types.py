"""What a message, service or action type is used in, and what uses one of its fields."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.facts import FileKind, Interface, Location
from kg.impact.files import mentions
from kg.impact.model import Area, DefinitionRecord, Effect, FileRecord, Grade, Kind, Subject, World

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Mapping, Sequence

    from kg.launch.comparison.changes import Record

_CHANNEL_KINDS: Final = {"topic": "msg", "service": "srv", "action": "action"}
_CODE: Final = frozenset({FileKind.CPP, FileKind.PYTHON})
_USING: Final = frozenset({*_CODE, FileKind.BUILD, FileKind.LAUNCH, FileKind.CONFIG})
_Type = tuple[str, str]
"""Kind of definition (`msg`, `srv`, `action`) and `package/Type`."""


def type_effects(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield what depends on a type or, for a field, on the type that has it."""
    name = subject.owner if subject.kind is Kind.FIELD else subject.name
    affected = affected_types(name, world.definitions(subject))
    yield from _embedding(subject, world, affected)
    started = _started(subject, world)
    using: set[tuple[str, str]] = set()
    for record in world.nodes(subject):
        for end in record.node.interfaces:
            if uses_type(end, affected):
                using.add((record.repository, record.package))
                yield _endpoint(subject, record, end, affected[_type_of(end)], started)
    if subject.kind is Kind.TYPE:
        yield from _dependents(name, world, using)


def type_about(subject: Subject, world: World) -> list[str]:
    """Return where a type is defined."""
    name = subject.owner if subject.kind is Kind.FIELD else subject.name
    places = [f"defined at {one.definition.location}" for one in world.definitions(subject) if one.name == name]
    return places or ["defined outside of the sources"]


def affected_types(name: str, definitions: Sequence[DefinitionRecord]) -> Mapping[_Type, tuple[str, ...]]:
    """Return the types whose definition changes with that of `name`, each with the types that lead to it."""
    holders: dict[str, list[DefinitionRecord]] = {}
    for one in definitions:
        for embedded in {*one.embeds.values()}:
            holders.setdefault(embedded, []).append(one)
    affected: dict[_Type, tuple[str, ...]] = {(kind, name): () for kind in _CHANNEL_KINDS.values()}
    queue: list[tuple[str, tuple[str, ...]]] = [(name, ())]
    for embedded, path in queue:
        for holder in holders.get(embedded, ()):
            key = holder.definition.kind, holder.name
            if key not in affected:
                affected[key] = (*path, embedded)
                if holder.definition.kind == "msg":
                    queue.append((holder.name, affected[key]))
    return affected


def uses_type(end: Interface, affected: Mapping[_Type, tuple[str, ...]]) -> bool:
    """Check whether the type of an end is among the affected ones."""
    return _type_of(end) in affected


def _type_of(end: Interface) -> _Type:
    return _CHANNEL_KINDS[end.role.channel], end.type or ""


def _embedding(subject: Subject, world: World, affected: Mapping[_Type, tuple[str, ...]]) -> Iterator[Effect]:
    for one in world.definitions(subject):
        path = affected.get((one.definition.kind, one.name))
        if not path:
            continue
        for each in one.definition.fields:
            embedded = one.embeds.get(f"{each.section}/{each.name}")
            if embedded != path[-1]:
                continue
            direct = len(path) == 1 and subject.kind is Kind.TYPE
            yield Effect(
                Grade.BREAKS if direct else Grade.MAY,
                Area.DEFINITIONS,
                f"{one.name} embeds {embedded} as {each.name}",
                "the field has this type" if direct else f"its definition changes with {path[0]}",
                Location(one.definition.location.path, each.line),
                one.definition.location.repository or one.repository,
            )


def _started(subject: Subject, world: World) -> Mapping[Hashable, set[str]]:
    """Return the launch files that start a node with an end, by the end."""
    by_end: dict[Hashable, set[str]] = {}
    for system in world.systems(subject):
        for instance in system.instances:
            for end in instance.interfaces:
                key = end.owner.package, end.owner.node, end.declared.role, end.declared.location
                by_end.setdefault(key, set()).add(system.configuration.name)
    return by_end


def _endpoint(
    subject: Subject, record: Record, end: Interface, path: tuple[str, ...], started: Mapping[Hashable, set[str]]
) -> Effect:
    key = record.package, record.node.name, end.role, end.location
    through = f", which embeds it through {' in '.join(path)}" if path else ""
    if subject.kind is Kind.FIELD:
        grade, reason = Grade.MAY, "breaks if it uses the field; all ends of a channel need the same definition"
    elif path:
        grade, reason = Grade.MAY, "has to be built again; all ends of a channel need the same definition"
    else:
        grade, reason = Grade.BREAKS, "is made with the type"
    return Effect(
        grade,
        Area.CODE,
        f"{record.package}/{record.node.name} {end.role.verb} {end.name or '?'} ({end.type}{through})",
        reason,
        end.location,
        end.location.repository or record.repository,
        tuple(sorted(started.get(key, ()))),
    )


def _dependents(name: str, world: World, using: set[tuple[str, str]]) -> Iterator[Effect]:
    owner = name.partition("/")[0]
    for package in world.dependents(owner):
        lines = [one.line for one in package.dependencies]
        certain = (package.repository, package.name) in using
        yield Effect(
            Grade.BREAKS if certain else Grade.MAY,
            Area.PACKAGES,
            f"{package.name} depends on {owner}",
            "its nodes use the type" if certain else "its code may use the type",
            Location(package.manifest, min(lines)),
            package.repository,
        )


def type_mentions(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield the lines that name a type, in packages that depend on its package and in that itself."""
    package, _, name = subject.name.partition("/")
    spelled = "|".join(
        (
            rf"{package}(?:/|::|\.)(?:(?:msg|srv|action)(?:/|::|\.))?{name}\b",
            rf"{package}/(?:msg|srv|action)/{_snake(name)}\.(?:hpp|h)\b",
            rf"from\s+{package}\.(?:msg|srv|action)\s+import\b.*\b{name}\b",
            rf"\b(?:msg|srv|action)/{name}\.(?:msg|srv|action)\b",
        )
    )
    files = (file for file in _near(world, package) if file.kind in _USING)
    yield from mentions(world, files, [name, _snake(name)], re.compile(spelled), "names the type")


def field_mentions(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield the lines that may use a field: in the files of nodes with ends whose messages have it."""
    affected = affected_types(subject.owner, world.definitions(subject))
    places: set[tuple[str, str]] = set()
    for record in world.nodes(subject):
        ends = [one for one in record.node.interfaces if uses_type(one, affected)]
        places.update((end.location.repository or record.repository, end.location.path) for end in ends)
        places.update((record.repository, path) for path in (record.node.sources if ends else ()))
    field = subject.name.partition(".")[0]
    name = re.escape(field)
    pattern = re.compile(rf"(?:\.|->){name}\b(?!\s*\()|\bset__{name}\b|[(,]\s*{name}\s*=(?!=)")
    files = [one for one in world.files if one.kind in _CODE and (one.repository, one.path) in places]
    yield from mentions(world, files, [field], pattern, f"possible use of the field {subject.name}")
    launch = [one for one in world.files if one.kind is FileKind.LAUNCH and _names(world, one, subject.owner)]
    pattern = re.compile(rf"\.{name}\b")
    yield from mentions(world, launch, [field], pattern, f"possible use of the field {subject.name} in an expression")


def _names(world: World, file: FileRecord, name: str) -> bool:
    package, _, bare = name.partition("/")
    text = "\n".join(world.lines(file.repository, file.path))
    return package in text and bare in text


def _near(world: World, package: str) -> list[FileRecord]:
    """Return the files of a package and of those that depend on it."""
    names = {(one.repository, one.name) for one in world.dependents(package)}
    return [one for one in world.files if one.package == package or (one.repository, one.package) in names]


def _snake(name: str) -> str:
    """Return the name of the header that ROS 2 generates for a type: `TwistStamped` gives `twist_stamped`."""
    spaced = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", spaced).lower()
