"""The graphs of launch configurations, kept in step with the sources of a store inside the transaction of a build.

What launch files start is read with their packages (`kg.extract.launch`); which node types that are, and what names
they get, depends on other packages too. So each package remembers which packages its launch files name, and its
systems are wired again when the results of any of these changed, or of any that has plugins to load. Only graphs whose
content differs are written.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.graph.reading import node_records, programs
from kg.graph.systems import system_triples
from kg.pipeline import cache
from kg.pipeline.report import totals
from kg.pipeline.state import PackageSystems
from kg.wiring.similar import Alike
from kg.wiring.systems import wire
from kg.wiring.types import NodeTypes

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from kg.facts import LaunchConfiguration, NodeReference
    from kg.graph.iris import Iris
    from kg.graph.reading import NodeRecord, Queryable
    from kg.pipeline.plan import Key
    from kg.pipeline.report import SystemsReport
    from kg.pipeline.state import PackageState, Systems
    from kg.store.transaction import EmbeddedTransaction

__all__ = ["node_types", "update_systems", "used_packages"]

_BYTES: Final = 16


def update_systems(  # noqa: PLR0913, PLR0917 - all that systems depend on
    transaction: EmbeddedTransaction,
    folder: Path,
    iris: Iris,
    packages: Mapping[Key, PackageState],
    last: Systems,
    version: str,
    *,
    touched: frozenset[str] | None = frozenset(),
) -> tuple[Systems, SystemsReport]:
    """Write the systems of all `packages` of the store, and take out those of packages that are gone.

    `folder` is the cache, `last` what the last build left, `version` stands for the code in force, `touched` are the
    graphs that others wrote since then, None where that is not known. Returns what the next one compares with.
    """
    earlier = {(source, path): one for source, found in last.items() for path, one in found.items()}
    work = _Work(transaction, folder, iris, packages, version)
    present = {graph.value for graph in transaction.graphs()}
    intact = set[str]() if touched is None else present - touched
    found = {key: work.kept(key, systems, intact) for key, systems in earlier.items() if key in packages}
    kept = {key: systems for key, systems in found.items() if systems is not None}
    anew = [key for key, package in packages.items() if package.counts.get("launches") and key not in kept]
    wired = work.wire(anew)
    systems = {**kept, **{key: one for key, (one, _) in wired.items()}}
    contents = {
        iris.launch_graph(key[0], path): content
        for key, (_, graphs) in wired.items()
        for path, content in graphs.items()
    }
    before = {
        iris.launch_graph(key[0], path): mark for key, one in earlier.items() for path, mark in one.graphs.items()
    }
    after = {iris.launch_graph(key[0], path): mark for key, one in systems.items() for path, mark in one.graphs.items()}
    known = tuple(iris.launch_graph(source, "") for source, _ in {*packages, *earlier})
    gone = [graph for graph in sorted(present) if known and graph.startswith(known) and graph not in after]
    written = {
        graph: content
        for graph, content in contents.items()
        if graph not in intact or before.get(graph) != after[graph]
    }
    for graph in gone:
        transaction.drop_graph(NamedNode(graph))
    if written:
        transaction.replace_small_graphs({NamedNode(graph): content for graph, content in written.items()})
    state: Systems = {}
    for (source, path), one in sorted(systems.items()):
        state.setdefault(source, {})[path] = one
    return state, replace(totals(state), changed=len(written) + len(gone))


def used_packages(configurations: Iterable[LaunchConfiguration]) -> set[str]:
    """Return the names of the packages that launch files start nodes of."""
    names: set[str] = set()
    for configuration in configurations:
        for node in configuration.nodes:
            names.add(node.package or "")
            names.add((node.plugin or "").partition("/")[0].partition("::")[0])
    return names - {""}


def node_types(graph: Queryable, packages: Iterable[str]) -> tuple[NodeTypes, dict[NodeReference, NodeRecord]]:
    """Return the node types of some packages, with their records by reference, and what else all packages install."""
    records = node_records(graph, packages=packages)
    pairs = [(record.reference, record.node) for record in records]
    return NodeTypes(pairs, programs=programs(graph)), {record.reference: record for record in records}


class _Work:
    """What the wiring of one build shares."""

    def __init__(
        self,
        transaction: EmbeddedTransaction,
        folder: Path,
        iris: Iris,
        packages: Mapping[Key, PackageState],
        version: str,
    ) -> None:
        self._transaction = transaction
        self._folder = folder
        self._iris = iris
        self._packages = packages
        self._version = version
        self._results: dict[str, list[str]] = {}
        for (source, path), package in sorted(packages.items()):
            self._results.setdefault(package.name, []).append(f"{source} {path} {package.result}")
        self._loadable = {package.name for package in packages.values() if package.counts.get("loadable")}
        self._shared = self._digest(sorted(self._loadable))
        self._names = Alike(self._results)
        """What a package that is not there may mean."""

    def kept(self, key: Key, earlier: PackageSystems, present: set[str]) -> PackageSystems | None:
        """Return the systems of a package where nothing that they depend on changed, and their graphs are there."""
        whole = all(self._iris.launch_graph(key[0], path) in present for path in earlier.graphs)
        return earlier if whole and earlier.basis == self._basis(key, earlier.uses) else None

    def wire(self, keys: Iterable[Key]) -> dict[Key, tuple[PackageSystems, dict[str, bytes]]]:
        """Return the systems of packages with the content of their graphs by path."""
        launches = {key: cache.launches(self._folder, self._packages[key].result) or () for key in keys}
        used = {key: used_packages(configurations) for key, configurations in launches.items()}
        if not any(launches.values()):
            return {}
        types, records = node_types(self._transaction, self._loadable.union(*used.values()))
        found = {}
        for key, configurations in launches.items():
            contents, instances = {}, 0
            for configuration in configurations:
                system = wire(configuration, types)
                contents[configuration.path] = system_triples(system, records, self._iris)
                instances += len(system.instances)
            uses = tuple(sorted(used[key]))
            marks = {path: _mark(content) for path, content in contents.items()}
            found[key] = PackageSystems(uses, self._basis(key, uses), marks, instances), contents
        return found

    def _basis(self, key: Key, uses: Iterable[str]) -> str:
        names = list(uses)
        alike = ",".join(name for use in names if use not in self._results for name in self._names.find(use))
        own = self._packages[key].result
        return _mark(f"{self._version} {own} {self._shared} {self._digest(names)} {alike}".encode())

    def _digest(self, names: Iterable[str]) -> str:
        return _mark("\n".join(line for name in names for line in (name, *self._results.get(name, ()))).encode())


def _mark(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=_BYTES).hexdigest()
