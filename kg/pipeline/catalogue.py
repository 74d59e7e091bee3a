"""Node types of all packages of a store, from their cached results, with a record of look-ups by wiring.

The state of a build contains the names of everything that can be started. A node type is decoded when it is looked up.
Look-ups are recorded with digests of their results; a system is wired again when one changes.
"""

from __future__ import annotations

from collections import OrderedDict
from itertools import groupby
from typing import TYPE_CHECKING, Final

from kg.facts import DataFile, NodeName, NodeReference, System
from kg.graph.nodes import Stated
from kg.graph.reading.nodes import NodeRecord
from kg.launch.wiring.types import NodeTypes, Typed
from kg.pipeline import cache
from kg.pipeline.visible import digest, visible_types

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from kg.pipeline.plan import Key
    from kg.pipeline.state import PackageState, Question

_DECODED: Final = 16
"""Number of packages with decoded node types in memory; systems of a package start nodes of few others."""


class Catalogue(NodeTypes):
    """The node types of `packages`, whose results are in the cache `folder`, and those of other sources of the store.

    `programs` contains programs that packages of other sources install, `data` their files that nodes read. `questions`
    records the look-ups since it was cleared.
    """

    def __init__(
        self,
        folder: Path,
        packages: Mapping[Key, PackageState],
        others: Iterable[NodeRecord] = (),
        programs: Mapping[str, Iterable[str]] | None = None,
        data: Iterable[DataFile] = (),
    ) -> None:
        self.questions: dict[Question, None] = {}
        self._folder = folder
        self._marks: dict[Question, str] = {}
        self._places: list[tuple[Key, NodeReference, NodeName, int]] = []
        self._results = {key: package.result for key, package in packages.items()}
        self._given: dict[Key, list[NodeRecord]] = {}
        """Node types of other sources."""
        self._decoded: OrderedDict[Key, list[NodeRecord]] = OrderedDict()
        visible = {(key[0], package.name, key): package.known for key, package in packages.items()}
        for (repository, package), records in groupby(others, key=lambda one: (one.repository, one.package)):
            whole = {one.iri: one for one in records}
            stated = (
                Stated(one.node, one.iri, tuple(one.ends.values()), tuple(one.settable.values()))
                for one in whole.values()
            )
            ordered, view = visible_types(stated)
            key = (repository, f"{package}/")
            self._given[key] = [whole[one.iri] for one in ordered]
            visible[repository, package, key] = view
        files = list(data)
        for (repository, package, key), view in sorted(visible.items(), key=lambda item: item[0]):
            files += view.data
            for at, one in enumerate(view.nodes):
                self._places.append((key, NodeReference(repository, package, one.name), one, at))
        self._add_data(files)
        self._by_reference = {reference: at for at, (_, reference, _, _) in enumerate(self._places)}
        self._index((reference.package, one) for _, reference, one, _ in self._places)
        self._packages.update((package for _, package, _ in visible), programs or ())
        for package, names in (
            *((package, view.programs) for (_, package, _), view in visible.items()),
            *(programs or {}).items(),
        ):
            self._programs.setdefault(package, set()).update(names)

    def has(self, package: str) -> bool:
        """Return whether the build has a package."""
        self.questions["has", package] = None
        return super().has(package)

    def installed(self, package: str) -> list[str]:
        """Return the other programs that a package installs, sorted."""
        self.questions["installed", package] = None
        return super().installed(package)

    def executables(self, package: str) -> list[str]:
        """Return the programs of a package that are nodes, sorted."""
        self.questions["executables", package] = None
        return super().executables(package)

    def started(self, package: str, name: str) -> list[Typed]:
        """Return the node types started by the name of a program of a package."""
        self.questions["started", package, name] = None
        return super().started(package, name)

    def loaded(self, name: str) -> list[Typed]:
        """Return the node types loaded by the name of a class."""
        self.questions["loaded", name] = None
        return super().loaded(name)

    def data(self, package: str) -> list[DataFile]:
        """Return the files of a package that nodes read at run time."""
        self.questions["data", package] = None
        return super().data(package)

    def like(self, package: str) -> tuple[str, ...]:
        """Return suggestions for the name of a package that does not exist."""
        self.questions["like", package] = None
        return super().like(package)

    def typed(self, at: int) -> Typed:
        """Return one of the node types by its index."""
        return self._places[at][1], self._record(at).node

    def records(self, system: System) -> dict[NodeReference, NodeRecord]:
        """Return the node types referenced in a system."""
        records = {}
        for reference in _references(system):
            self.questions["record", reference.repository, reference.package, reference.node] = None
            at = self._by_reference.get(reference)
            if at is not None:
                records[reference] = self._record(at)
        return records

    def learn(self, marks: Mapping[Question, str]) -> None:
        """Take the digests of the results of look-ups from another catalogue of the same packages."""
        self._marks.update(marks)

    def mark(self, question: Question) -> str:
        """Return a digest of the result of a look-up."""
        if question not in self._marks:
            self._marks[question] = digest(repr(self._answer(*question)).encode())
        return self._marks[question]

    def _answer(self, kind: str, *names: str) -> object:
        match kind:
            case "started":
                return self._marks_of(self._started.get((names[0], names[1]), ()))
            case "loaded":
                return self._marks_of(self._loaded.get(names[0], ()))
            case "record":
                at = self._by_reference.get(NodeReference(*names))
                return self._marks_of(() if at is None else (at,))
            case _:
                return getattr(super(), kind)(*names)

    def _marks_of(self, places: Iterable[int]) -> list[tuple[str, str]]:
        return [(str(reference), one.mark) for _, reference, one, _ in (self._places[at] for at in places)]

    def _record(self, at: int) -> NodeRecord:
        key, reference, _, place = self._places[at]
        if key in self._given:
            return self._given[key][place]
        if key not in self._decoded:
            if len(self._decoded) >= _DECODED:
                self._decoded.popitem(last=False)
            self._decoded[key] = [
                NodeRecord(
                    reference.repository,
                    None,
                    reference.package,
                    one.node,
                    one.iri,
                    dict(zip(one.node.interfaces, one.ends, strict=True)),
                    dict(zip(one.node.parameters, one.settable, strict=True)),
                )
                for one in cache.nodes(self._folder, self._results[key])
            ]
        self._decoded.move_to_end(key)
        return self._decoded[key][place]


def _references(system: System) -> Iterator[NodeReference]:
    """Yield the node types of instances and plugins in a system, each once."""
    references: dict[NodeReference | None, None] = {}
    for instance in system.instances:
        references.update(dict.fromkeys((instance.type, *instance.plugins)))
        references.update((end.owner, None) for end in instance.interfaces)
        references.update((parameter.owner, None) for parameter in instance.parameters)
    yield from (reference for reference in references if reference is not None)
