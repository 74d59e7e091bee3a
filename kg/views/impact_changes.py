"""Breaking changes of a state of the sources against an earlier one: two stores are read where they differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.facts import Location
from kg.graph.reading.impact import definition_records, file_records
from kg.graph.reading.nodes import node_records
from kg.graph.reading.systems import systems
from kg.impact.changes import Broken, broken, definition_changes
from kg.impact.model import Kind, Subject
from kg.launch.comparison import Finding, Sources, compare
from kg.lint.reading import read_findings
from kg.pipeline.state import State, load
from kg.views.impact_world import StoredWorld
from kg.views.systems import configuration_names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.graph.reading.nodes import NodeRecord
    from kg.graph.reading.systems import SystemName
    from kg.lint.finding import Finding as Found
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.snapshot import EmbeddedSnapshot


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
