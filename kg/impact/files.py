"""What a file declares and is used by."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.facts import FileKind, Location
from kg.impact.launches import include_effects
from kg.impact.model import Area, Effect, Grade, Kind, Subject, World
from kg.impact.texts import mentions
from kg.render.text import count

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.launch.comparison.changes import Record

_NAMING: Final = frozenset({FileKind.LAUNCH, FileKind.BUILD, FileKind.CONFIG, FileKind.CPP, FileKind.PYTHON})


def declared_subjects(subject: Subject, world: World) -> list[Subject]:
    """Return the nodes and types that a file declares."""
    place = subject.owner, subject.name
    nodes = [
        Subject(Kind.NODE, f"{one.package}/{one.node.name}")
        for one in world.nodes(subject)
        if place == (one.node.location.repository or one.repository, one.node.location.path)
    ]
    types = [
        Subject(Kind.TYPE, one.name)
        for one in world.definitions(subject)
        if place == (one.repository, one.definition.location.path)
    ]
    return [*dict.fromkeys([*nodes, *types])]


def file_about(subject: Subject, world: World) -> list[str]:
    """Return the kind of a file and what it declares."""
    place = subject.owner, subject.name
    kinds = [f"{one.kind} file of {one.package}" for one in world.files_at(subject.name) if place[0] == one.repository]
    return [*kinds, *(f"declares {one.kind} {one.text}" for one in declared_subjects(subject, world))]


def file_effects(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield what is read from a file: node types, launch configurations and parameters."""
    place = subject.owner, subject.name
    for record in world.nodes(subject):
        yield from _node(record, place)
    systems = world.systems(subject)
    yield from include_effects(subject.name, subject.owner, systems, world)
    for system in systems:
        launch = system.configuration
        numbers: defaultdict[str, list[int]] = defaultdict(list)
        for instance in system.instances:
            for one in instance.parameters:
                if place == (one.set.location.repository or launch.repository, one.set.location.path):
                    numbers[instance.name].append(one.set.location.line)
        for name, lines in numbers.items() if subject.name != launch.path else ():
            yield Effect(
                Grade.BREAKS,
                Area.PARAMETERS,
                f"{name} is given {count(len(lines), 'parameter')} of it",
                "the launch file loads it",
                Location(subject.name, min(lines)),
                subject.owner,
                (launch.name,),
            )


def _node(record: Record, place: tuple[str, str]) -> Iterator[Effect]:
    node, name = record.node, f"{record.package}/{record.node.name}"
    facts = [
        *(one.location for one in node.interfaces if not one.implicit),
        *(one.location for one in node.parameters if not one.implicit),
        *(one.location for one in node.slots),
    ]
    lines = [one.line for one in facts if place == (one.repository or record.repository, one.path)]
    is_source = place[0] == record.repository and place[1] in {node.location.path, *node.sources}
    if lines or is_source:
        what = f"{name} has {len(lines)} interfaces and parameters in it" if lines else f"{name} is built from it"
        yield Effect(
            Grade.BREAKS,
            Area.CODE,
            what,
            "declares them there" if lines else "lists it as a source",
            Location(place[1], min(lines, default=0)),
            place[0],
        )
    exported = node.exported
    if exported is not None and place == (exported.repository or record.repository, exported.path):
        yield Effect(Grade.BREAKS, Area.PACKAGES, f"{name} is registered in it", "cannot be loaded", exported, place[0])


def file_mentions(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield the lines of other files that name a file."""
    base = subject.name.rpartition("/")[2]
    pattern = re.compile(rf"(?<![\w.-]){re.escape(base)}(?![\w.-])")
    files = [
        one
        for one in world.files
        if one.kind in _NAMING and (one.repository, one.path) != (subject.owner, subject.name)
    ]
    yield from mentions(world, files, [base], pattern, "names a file of this name")
