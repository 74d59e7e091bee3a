"""What breaks if a name is renamed, removed or changed: the view `impact`, and two states of the sources compared."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.errors import UsageError, choices
from kg.facts import Location
from kg.graph.reading.channels import channels_called
from kg.graph.reading.impact import arguments, definition_records, file_records, type_names
from kg.graph.reading.impact_nodes import (
    nodes_called,
    nodes_with_parameter,
    qualified_names,
    settable_names,
    types_called,
)
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.graph.reading.systems import SystemName, started_names, systems
from kg.impact.assessing import impact as assess
from kg.impact.changes import Broken, broken, definition_changes
from kg.impact.model import CHANNELS, Impact, Kind, Subject
from kg.impact.parameters import has_parameter, spellings
from kg.impact.writing import impact_object
from kg.launch.comparison import Finding, Sources, compare
from kg.lint.reading import read_findings
from kg.pipeline.launch_names import matching
from kg.pipeline.state import State, load
from kg.similar import did_you_mean, unknown
from kg.views.evidence import places
from kg.views.impact_world import StoredWorld
from kg.views.systems import configuration_names

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from kg.lint.finding import Finding as Found
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.snapshot import EmbeddedSnapshot

_SECTIONS: Final = frozenset({"msg", "srv", "action"})


def impact(snapshot: EmbeddedSnapshot, settings: Settings, *, name: str, kind: str = "") -> dict[str, Any]:
    """Return the impact of a change to what `name` means, as `kg impact --json` writes it (docs/formats.md).

    Raises:
        UnknownNameError: KG001 when nothing has the name, with those that were probably meant.
        UsageError: KG003 when it means several things, with a command for each.
    """
    return impact_object(impact_of(snapshot, settings, name, kind))


def impact_of(snapshot: EmbeddedSnapshot, settings: Settings, name: str, kind: str = "") -> Impact:
    """Return the impact of a change to the one thing that `name` means; raises as `impact`."""
    if kind and kind not in {str(one) for one in Kind}:
        raise UsageError(
            "KG003",
            f"unknown kind `{kind}`",
            hint=did_you_mean(kind, map(str, Kind)) or f"The kinds are {', '.join(Kind)}.",
        )
    world = StoredWorld(snapshot, settings)
    matches = [one for one in subjects(snapshot, world, name) if kind in {"", str(one.kind)}]
    if not matches:
        raise unknown(
            kind or "name", name, _candidates(snapshot, world, kind), otherwise="`kg search` finds nodes by words."
        )
    if len(matches) > 1:
        ways = choices([f"`kg impact {one.text} --kind {one.kind}`" for one in matches])
        raise UsageError("KG003", f"`{name}` means {len(matches)} things; choose one", hint=ways)
    return assess(matches[0], world)


def subjects(snapshot: EmbeddedSnapshot, world: StoredWorld, name: str) -> list[Subject]:
    """Return the meanings of a name: all with this name, else all whose name ends with it by whole segments."""
    exact = [
        *(Subject(Kind(kind), channel) for kind, channel in channels_called(snapshot, {name, f"/{name.lstrip('/')}"})),
        *_types(snapshot, world, name),
        *_nodes(snapshot, world, name),
        *_parameters(snapshot, world, name),
        *_arguments(snapshot, name),
        *_files(snapshot, world, name, whole=True),
    ]
    if exact:
        return [*dict.fromkeys(exact)]
    ending = f"/{name.lstrip('/')}"
    channels = [
        Subject(Kind(kind), one) for kind, names in world.channels.items() for one in names if one.endswith(ending)
    ]
    started = [Subject(Kind.NODE, one) for one in started_names(snapshot) if one.endswith(ending)]
    found = [*channels, *started, *_files(snapshot, world, name, whole=False)]
    return found or [one for one in _parameters(snapshot, world, ending) if assess(one, world).effects]


def _types(snapshot: EmbeddedSnapshot, world: StoredWorld, name: str) -> Iterator[Subject]:
    front, _, last = name.rpartition("/")
    bare, _, field = last.partition(".")
    package = "/".join(part for part in front.split("/") if part not in _SECTIONS)
    if front:
        candidates = types_called(snapshot, f"{package}/{bare}")
    else:
        candidates = type_names(snapshot, bare) if bare[:1].isupper() else []
    for type_name in candidates:
        subject = Subject(Kind.TYPE, type_name)
        if not field:
            yield subject
            continue
        definitions = [one.definition for one in world.definitions(subject) if one.name == type_name]
        fields = {each.name for one in definitions for each in one.fields}
        if not fields or field.partition(".")[0] in fields:
            yield Subject(Kind.FIELD, field, type_name)


def _nodes(snapshot: EmbeddedSnapshot, world: StoredWorld, name: str) -> Iterator[Subject]:
    if name.startswith("/"):
        if name in started_names(snapshot, name):
            yield Subject(Kind.NODE, name)
        return
    for record in world.records(nodes_called(snapshot, name)):
        yield Subject(Kind.NODE, f"{record.package}/{record.node.name}")


def _parameters(snapshot: EmbeddedSnapshot, world: StoredWorld, name: str) -> Iterator[Subject]:
    if nodes_with_parameter(snapshot, spellings(name)):
        yield Subject(Kind.PARAMETER, name)
    # Names of nodes and of parameters may both contain dots, so each dot may be between the two.
    splits = [(name[:at], name[at + 1 :]) for at, sign in enumerate(name) if sign == "."]
    for owner, inner in splits:
        subject = Subject(Kind.PARAMETER, inner, owner)
        having = [one for one in world.nodes(subject) if has_parameter(one, subject)]
        yield from (Subject(Kind.PARAMETER, inner, f"{one.package}/{one.node.name}") for one in having)
        if owner.startswith("/") and owner in started_names(snapshot, owner):
            yield Subject(Kind.PARAMETER, inner, owner)


def _arguments(snapshot: EmbeddedSnapshot, name: str) -> Iterator[Subject]:
    launch, _, argument = name.rpartition(":")
    declared = arguments(snapshot, argument)
    if declared and not launch:
        yield Subject(Kind.ARGUMENT, argument)
        return
    launches = {one.name for one in matching(configuration_names(snapshot), launch)} if launch else set()
    yield from (Subject(Kind.ARGUMENT, argument, owner) for _, owner in declared if owner in launches)


def _files(snapshot: EmbeddedSnapshot, world: StoredWorld, name: str, *, whole: bool) -> Iterator[Subject]:
    if "." not in name:
        return
    repository, _, path = name.rpartition(":")
    real = Path(name).resolve() if whole and Path(name).is_file() else None
    roots = {source.name: Path(source.root).resolve() for source in places(snapshot).sources.values() if source.root}
    own = [one for one in world.own if f"/{one.path}".endswith(f"/{path}")]
    named = world.files_at(path) if whole else [*file_records(snapshot, ending=path), *own]
    matches = {(one.repository, one.path) for one in named if repository in {"", one.repository}}
    for source, root in roots.items():
        if real is not None and real.is_relative_to(root):
            inner = real.relative_to(root).as_posix()
            matches |= {(source, one.path) for one in world.files_at(inner) if one.repository == source}
    yield from (
        Subject(Kind.FILE, inner, source) for source, inner in sorted(matches, key=lambda one: (not one[0], one))
    )


def _candidates(snapshot: EmbeddedSnapshot, world: StoredWorld, kind: str) -> set[str]:
    """Return the names that a misspelt one may mean."""
    if kind in CHANNELS:
        return set(world.channels[kind])
    names_by_kind: dict[str, Callable[[], Iterable[str]]] = {
        Kind.TYPE: lambda: type_names(snapshot),
        Kind.NODE: lambda: [*qualified_names(snapshot), *started_names(snapshot)],
        Kind.PARAMETER: lambda: settable_names(snapshot),
        Kind.ARGUMENT: lambda: [name for name, _ in arguments(snapshot)],
        Kind.FILE: lambda: [one.path.rpartition("/")[2] for one in (*file_records(snapshot), *world.own)],
    }
    candidates = {name for one, names in names_by_kind.items() if kind in {"", one} for name in names()}
    return candidates if kind else candidates.union(*world.channels.values())


def broken_between(before: EmbeddedStore, after: EmbeddedStore, settings: Settings) -> list[Broken]:
    """Return the changes from one store to another with what they break; both were built from the same sources."""
    states = load(before.layout.cache), load(after.layout.cache)
    packages, launches = _packages(*states), _launches(*states)
    with before.read() as old, after.read() as new:
        sides = _side(old, settings, packages, launches), _side(new, settings, packages, launches)
        pairs = {(one.configuration.repository, one.configuration.path): one for one in sides[0].systems}
        both = [
            (pairs[key], one)
            for one in sides[1].systems
            if (key := (one.configuration.repository, one.configuration.path)) in pairs
        ]
        worlds = StoredWorld(old, settings), StoredWorld(new, settings)
        remaining = {(one.repository, one.path) for one in file_records(new)}
        files = [
            Subject(Kind.FILE, one.path, one.repository)
            for one in file_records(old)
            if (one.repository, one.path) not in remaining
        ]
        gone = [*definition_changes(definition_records(old), definition_records(new)), *files]
        return broken(compare(*sides), worlds, both, gone)


def _side(
    snapshot: EmbeddedSnapshot, settings: Settings, packages: set[str], launches: set[tuple[str, str]]
) -> Sources:
    names = [one for one in configuration_names(snapshot) if (one.repository, one.path) in launches]
    nodes = node_records(snapshot, packages=packages) if packages else []
    return compared_sources(snapshot, settings, nodes, names)


def compared_sources(
    snapshot: EmbeddedSnapshot, settings: Settings, nodes: list[NodeRecord], names: Sequence[SystemName]
) -> Sources:
    """Return what `kg.launch.comparison` compares of a store: nodes, and systems with what `kg lint` found in them."""
    chosen = {one.name for one in names}
    findings = [_finding(one) for one in read_findings(snapshot, settings.base) if one.system in chosen]
    return Sources(nodes, systems(snapshot, names, settings.base), findings)


def _finding(finding: Found) -> Finding:
    place = finding.place
    location = Location(place.path, place.line) if place and place.line is not None else None
    subject = finding.subjects[0] if finding.subjects else ""
    return Finding(finding.system, finding.code, subject, finding.message, location, place.repository if place else "")


def _packages(before: State, after: State) -> set[str]:
    """Return the names of the packages whose facts differ."""
    both = [
        {(name, path): package for name, source in state.sources.items() for path, package in source.packages.items()}
        for state in (before, after)
    ]
    # Both ways round: packages that are gone are only in the first state, new ones only in the second.
    return {
        package.name
        for one, other in (both, both[::-1])
        for key, package in one.items()
        if key not in other or other[key].result != package.result
    }


def _launches(before: State, after: State) -> set[tuple[str, str]]:
    """Return the sources and paths of the launch files whose systems differ."""
    both = [
        {
            (name, path): system.graph
            for name, packages in state.systems.packages.items()
            for package in packages.values()
            for path, system in package.graphs.items()
        }
        for state in (before, after)
    ]
    return {key for key in {*both[0], *both[1]} if both[0].get(key) != both[1].get(key)}
