"""The sources of a store as input of `kg.impact`: the parts related to a subject are read, once for each."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.facts import FileKind, Location, System
from kg.graph.iris import Iris
from kg.graph.reading.impact import (
    configurations_in,
    configurations_with,
    definition_records,
    dependents,
    file_records,
    systems_naming,
)
from kg.graph.reading.impact_nodes import (
    definitions_at,
    definitions_of,
    nodes_at_channel,
    nodes_called,
    nodes_in_file,
    nodes_loading,
    nodes_of_types,
    nodes_with_parameter,
)
from kg.graph.reading.impact_parts import at_channel, at_file, at_node, at_parameter, of_types
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.graph.reading.systems import partial_systems, system_names
from kg.impact.model import CHANNELS, DefinitionRecord, FileRecord, Kind, PackageRecord, Subject
from kg.impact.parameters import has_parameter, spellings
from kg.impact.types import affected_types, uses_type
from kg.settings import Settings, user_paths
from kg.views.answers import channel_names, partial_names, set_names
from kg.views.evidence import places

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from kg.graph.usual_ends import UsualEnd
    from kg.store.snapshot import EmbeddedSnapshot

_LARGEST: Final = 4 << 20
_OWN: Final = (".rq", ".srl", ".ttl", ".kgp")
"""Endings of files of the user that name things: queries, rules and programs."""


class StoredWorld:
    """The content of a snapshot, with the files of its sources if they are on this machine."""

    def __init__(self, snapshot: EmbeddedSnapshot, settings: Settings) -> None:
        self._snapshot = snapshot
        self._settings = settings
        self._iris = Iris(settings.base)
        self._lines: dict[tuple[str, str], Sequence[str]] = {}
        self._systems: dict[Subject, Sequence[System]] = {}
        self._nodes: dict[Subject, Sequence[NodeRecord]] = {}
        self._definitions: dict[Subject, Sequence[DefinitionRecord]] = {}
        self._dependents: dict[str, Sequence[PackageRecord]] = {}

    @cached_property
    def channels(self) -> Mapping[str, Sequence[str]]:
        """The names of all topics, services and actions by kind, in systems and in code alone."""
        return channel_names(self._snapshot)

    def nodes(self, subject: Subject) -> Sequence[NodeRecord]:
        """Return the node types that may have to do with a subject."""
        if subject not in self._nodes:
            self._nodes[subject] = self.records(self._concerned(subject))
        return self._nodes[subject]

    def records(self, iris: Collection[str]) -> list[NodeRecord]:
        """Return the node types of some IRIs."""
        return node_records(self._snapshot, iris=iris) if iris else []

    def definitions(self, subject: Subject) -> Sequence[DefinitionRecord]:
        """Return the definitions that a subject means or changes, and those in a file."""
        if subject not in self._definitions:
            iris: Collection[str] = ()
            if subject.kind in {Kind.TYPE, Kind.FIELD}:
                iris = definitions_of(self._snapshot, [subject.owner or subject.name])
            elif subject.kind is Kind.FILE:
                iris = definitions_at(self._snapshot, subject.name)
            self._definitions[subject] = definition_records(self._snapshot, iris) if iris else []
        return self._definitions[subject]

    def dependents(self, package: str) -> Sequence[PackageRecord]:
        """Return the packages that depend on one, each with its dependencies on that."""
        if package not in self._dependents:
            self._dependents[package] = dependents(self._snapshot, package)
        return self._dependents[package]

    @cached_property
    def own(self) -> Sequence[FileRecord]:
        """The rules, queries and programs of the user."""
        folders = {one for name in ("rules", "queries", "ontology") for one in user_paths(self._settings, name)}
        paths = sorted({path for folder in folders for path in folder.rglob("*") if path.suffix in _OWN})
        return [FileRecord("", "", str(path), FileKind.CONFIG) for path in paths]

    @cached_property
    def files(self) -> Sequence[FileRecord]:
        """The files of packages whose source is on this machine, and those of the user."""
        sources = places(self._snapshot).sources
        there = [name for name, source in sources.items() if source.root and Path(source.root).is_dir()]
        return [*(file_records(self._snapshot, sources=there) if there else ()), *self.own]

    def files_at(self, path: str) -> Sequence[FileRecord]:
        """Return the files of this path, of any source and of the user."""
        return [*file_records(self._snapshot, path=path), *(one for one in self.own if one.path == path)]

    def systems(self, subject: Subject) -> Sequence[System]:
        """Return the launch configurations that state a subject, or start what declares it, with its parts of them."""
        if subject not in self._systems:
            snapshot, base, (parts, usual) = self._snapshot, self._settings.base, self._parts(subject)
            if subject.kind is Kind.PARAMETER and not subject.owner:
                partial = partial_systems(snapshot, None, parts, base, usual)
            else:
                having = {end.system for end in usual} | configurations_in(snapshot, self._graphs(subject))
                names = system_names(snapshot, having) if having else []
                partial = partial_systems(snapshot, names, parts, base, usual, launches=True)
            self._systems[subject] = partial
        return self._systems[subject]

    def lines(self, repository: str, path: str) -> Sequence[str]:
        """Return the lines of a file; none if it is large, or not on this machine."""
        key = repository, path
        if key not in self._lines:
            file = places(self._snapshot).file(repository, Location(path, 0)) if repository else Path(path)
            try:
                is_readable = file is not None and file.stat().st_size <= _LARGEST
                self._lines[key] = file.read_text("utf-8", "replace").splitlines() if file and is_readable else ()
            except OSError:
                self._lines[key] = ()
        return self._lines[key]

    def _graphs(self, subject: Subject) -> set[str]:
        """Return the named graphs of the launch configurations that may have to do with a subject."""
        if subject.kind in CHANNELS:
            named = [
                one for one in self.nodes(subject) if any(end.resolved == subject.name for end in one.node.interfaces)
            ]
            return systems_naming(self._snapshot, [subject.name], [one.iri for one in named])
        if subject.kind in {Kind.TYPE, Kind.FIELD}:
            affected = self._affected(subject)
            using = [one for one in self.nodes(subject) if any(uses_type(end, affected) for end in one.node.interfaces)]
            return systems_naming(self._snapshot, (), [one.iri for one in using])
        if subject.kind is Kind.NODE:
            return systems_naming(self._snapshot, [subject.name], self._types_called(subject))
        if subject.kind is Kind.PARAMETER and subject.owner and not subject.owner.startswith("/"):
            having = [one.iri for one in self.nodes(subject) if has_parameter(one, subject)]
            return systems_naming(self._snapshot, (), having)
        if subject.kind is Kind.PARAMETER and subject.owner:
            return systems_naming(self._snapshot, [subject.owner], ())
        if subject.kind is Kind.FILE:
            own = [
                one.iri
                for one in self.nodes(subject)
                if (subject.owner, subject.name) == (one.repository, one.node.location.path)
            ]
            included = [self._iris.configuration(subject.owner, subject.name)]
            return systems_naming(self._snapshot, [subject.name], own, included)
        return systems_naming(self._snapshot, (), (), configurations_with(self._snapshot, subject.name))

    def _parts(self, subject: Subject) -> tuple[list[tuple[str, str]], list[UsualEnd]]:
        """Return the parts of systems that may have to do with a subject: those that are stated, and usual ends."""
        if subject.kind in CHANNELS:
            return at_channel(self._snapshot, subject.kind, subject.name, partial_names(self._snapshot))
        if subject.kind in {Kind.TYPE, Kind.FIELD}:
            return of_types(self._snapshot, (name for _, name in self._affected(subject)))
        if subject.kind is Kind.NODE:
            return at_node(self._snapshot, subject.name, self._types_called(subject)), []
        if subject.kind is Kind.PARAMETER:
            return at_parameter(subject.name, set_names(self._snapshot)), []
        return at_file(subject.name) if subject.kind is Kind.FILE else [], []

    def _concerned(self, subject: Subject) -> set[str]:
        """Return the IRIs of the node types that a subject may be in."""
        snapshot, name = self._snapshot, subject.name
        if subject.kind in CHANNELS:
            return nodes_at_channel(snapshot, name)
        if subject.kind in {Kind.TYPE, Kind.FIELD}:
            return nodes_of_types(snapshot, (one for _, one in self._affected(subject)))
        if subject.kind is Kind.NODE:
            own = nodes_called(snapshot, name)
            plugins = {one.node.plugin for one in self.records(own) if one.node.plugin}
            return own | nodes_loading(snapshot, plugins)
        if subject.kind is Kind.PARAMETER and subject.owner:
            return nodes_called(snapshot, subject.owner, at_run_time=True)
        if subject.kind is Kind.PARAMETER:
            return nodes_with_parameter(snapshot, spellings(name))
        return nodes_in_file(snapshot, name) if subject.kind is Kind.FILE else set()

    def _affected(self, subject: Subject) -> Mapping[tuple[str, str], tuple[str, ...]]:
        """Return the types that a change to a type or one of its fields reaches."""
        return affected_types(subject.owner or subject.name, self.definitions(subject))

    def _types_called(self, subject: Subject) -> list[str]:
        return [one.iri for one in self.nodes(subject) if f"{one.package}/{one.node.name}" == subject.name]
