"""The sources of a store as `kg.impact` takes them: each part is read when it is first needed."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.facts import FileKind, Location
from kg.graph.channels_reading import every_name
from kg.graph.impact_parts import at_channel, at_file, at_node, at_parameter, of_types
from kg.graph.impact_reading import definition_records, file_records, package_records, systems_naming
from kg.graph.iris import Iris
from kg.graph.reading import node_records
from kg.graph.systems_reading import partial_systems
from kg.impact import CHANNELS, FileRecord, Kind
from kg.impact.parameters import has_parameter
from kg.impact.types import affected_types, uses_type
from kg.settings import user_paths
from kg.views.evidence import places
from kg.views.systems import known_names

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.facts import System
    from kg.graph.reading import NodeRecord
    from kg.graph.usual_ends import UsualEnd
    from kg.impact import DefinitionRecord, PackageRecord, Subject
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["StoredWorld"]

_LARGEST: Final = 4 << 20
_OWN: Final = (".rq", ".srl", ".ttl", ".kgp")
"""Endings of files of the user that name things: queries, rules and programs."""


class StoredWorld:
    """What a snapshot holds, with the files of its sources where they are on this machine."""

    def __init__(self, snapshot: EmbeddedSnapshot, settings: Settings) -> None:
        self._snapshot = snapshot
        self._settings = settings
        self._iris = Iris(settings.base)
        self._lines: dict[tuple[str, str], Sequence[str]] = {}
        self._systems: dict[Subject, Sequence[System]] = {}

    @cached_property
    def nodes(self) -> Sequence[NodeRecord]:
        """All node types."""
        return node_records(self._snapshot)

    @cached_property
    def channels(self) -> Mapping[str, Sequence[str]]:
        """The names of topics, services and actions by kind, in systems and in code alone."""
        return every_name(self._snapshot)

    @cached_property
    def packages(self) -> Sequence[PackageRecord]:
        """All packages."""
        return package_records(self._snapshot)

    @cached_property
    def definitions(self) -> Sequence[DefinitionRecord]:
        """All definitions."""
        return definition_records(self._snapshot)

    @cached_property
    def files(self) -> Sequence[FileRecord]:
        """The files of packages, and the rules, queries and programs of the user."""
        folders = {*user_paths(self._settings, "rules"), *user_paths(self._settings, "queries")}
        own = sorted({path for folder in folders for path in folder.rglob("*") if path.suffix in _OWN})
        return [*file_records(self._snapshot), *(FileRecord("", "", str(path), FileKind.CONFIG) for path in own)]

    def systems(self, subject: Subject) -> Sequence[System]:
        """Return the launch configurations that state a subject, or start what declares it, with its parts of them."""
        if subject not in self._systems:
            graphs, (parts, usual) = self._graphs(subject), self._parts(subject)
            having = {end.system for end in usual}
            names = [
                one
                for one in known_names(self._snapshot)
                if self._iris.system_graph(one.repository, one.path) in graphs
                or self._iris.configuration(one.repository, one.path) in having
            ]
            base = self._settings.base
            self._systems[subject] = partial_systems(self._snapshot, names, parts, base, usual, launches=True)
        return self._systems[subject]

    def lines(self, repository: str, path: str) -> Sequence[str]:
        """Return the lines of a file; none if it is large, or not on this machine."""
        key = repository, path
        if key not in self._lines:
            file = places(self._snapshot).file(repository, Location(path, 0)) if repository else Path(path)
            self._lines[key] = _read(file) if file else ()
        return self._lines[key]

    def _graphs(self, subject: Subject) -> set[str]:
        """Return the named graphs of the launch configurations that may have to do with a subject."""
        if subject.kind in CHANNELS:
            named = [one for one in self.nodes if any(end.resolved == subject.name for end in one.node.interfaces)]
            return systems_naming(self._snapshot, [subject.name], [one.iri for one in named])
        if subject.kind in {Kind.TYPE, Kind.FIELD}:
            affected = affected_types(self, subject.owner or subject.name)
            using = [one for one in self.nodes if any(uses_type(end, affected) for end in one.node.interfaces)]
            return systems_naming(self._snapshot, (), [one.iri for one in using])
        if subject.kind is Kind.NODE:
            return systems_naming(self._snapshot, [subject.name], self._types_called(subject.name))
        if subject.kind is Kind.PARAMETER and subject.owner and not subject.owner.startswith("/"):
            return systems_naming(self._snapshot, (), [one.iri for one in self.nodes if has_parameter(one, subject)])
        if subject.kind is Kind.PARAMETER and subject.owner:
            return systems_naming(self._snapshot, [subject.owner], ())
        if subject.kind is Kind.FILE:
            own = [
                one.iri
                for one in self.nodes
                if (subject.owner, subject.name) == (one.repository, one.node.location.path)
            ]
            included = [self._iris.configuration(subject.owner, subject.name)]
            return systems_naming(self._snapshot, [subject.name], own, included)
        return {self._iris.system_graph(one.repository, one.path) for one in known_names(self._snapshot)}

    def _parts(self, subject: Subject) -> tuple[list[tuple[str, str]], list[UsualEnd]]:
        """Return the parts of systems that may have to do with a subject: those that are stated, and usual ends."""
        if subject.kind in CHANNELS:
            return at_channel(self._snapshot, subject.kind, subject.name)
        if subject.kind in {Kind.TYPE, Kind.FIELD}:
            affected = affected_types(self, subject.owner or subject.name)
            return of_types(self._snapshot, (name for _, name in affected))
        if subject.kind is Kind.NODE:
            return at_node(self._snapshot, subject.name, self._types_called(subject.name)), []
        if subject.kind is Kind.PARAMETER:
            return at_parameter(subject.name), []
        return at_file(subject.name) if subject.kind is Kind.FILE else [], []

    def _types_called(self, name: str) -> list[str]:
        return [one.iri for one in self.nodes if f"{one.package}/{one.node.name}" == name]


def _read(file: Path) -> Sequence[str]:
    try:
        return file.read_text("utf-8", "replace").splitlines() if file.stat().st_size <= _LARGEST else ()
    except OSError:
        return ()
