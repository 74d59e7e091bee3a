"""Graphs of launch configurations, kept consistent with a store's sources in the transaction of a build.

The starts of launch files are read with their packages (`kg.launch.files`). Their node types and names depend on other
packages too. So each system records the look-ups of node types by its wiring (`kg.pipeline.catalogue`). It is wired
again if a result changes, or if its launch file starts something else. Its graph is patched by the triples that differ.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.graph import vocabulary as v
from kg.graph.reading.nodes import NodeRecord, data_files, node_records, programs
from kg.graph.starts import STARTS, starts_apart
from kg.launch.wiring.types import NodeTypes
from kg.pipeline import cache
from kg.pipeline.catalogue import Catalogue
from kg.pipeline.report import SystemsReport, totals
from kg.pipeline.sharing import Described, keep_starts
from kg.pipeline.state import PackageState, PackageSystems, Question, Systems, WiredSystem
from kg.pipeline.wiring import Wired, mark_of, wired, wired_by
from kg.store.allocator import give_back

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from kg.facts import LaunchConfiguration, NodeReference
    from kg.graph.iris import Iris
    from kg.pipeline.plan import Key
    from kg.pipeline.pool import Pool
    from kg.store.interface import Queryable
    from kg.store.transaction import EmbeddedTransaction

_SMALL: Final = 2
"""A graph is patched if less than this fraction of its triples change (1/n)."""
_BATCH_BYTES: Final = 4 << 20
"""Size of content after which graphs are written together."""
_STARTED_WITH: Final = f" {v.STARTED_WITH} ".encode()


def update_systems(  # noqa: PLR0913, PLR0917 - all that systems depend on
    transaction: EmbeddedTransaction,
    folder: Path,
    iris: Iris,
    packages: Mapping[Key, PackageState],
    last: Systems,
    version: str,
    *,
    touched: frozenset[str] | None = frozenset(),
    pool: Pool | None = None,
) -> tuple[Systems, SystemsReport]:
    """Write the systems of all `packages` of the store, and remove those of packages that no longer exist.

    `folder` is the cache, `last` the state of the last build, `version` identifies the current code. `touched` contains
    the graphs that others have written since then, None if unknown. The workers of `pool` wire packages that have not
    been wired before. Returns the state for the next build.
    """
    present = {graph.value for graph in transaction.graphs()}
    intact = set[str]() if touched is None or iris.graph(STARTS) in touched else present - touched
    strangers = _strangers(iris, packages, present)
    catalogue = _with_strangers(transaction, folder, packages) if strangers else Catalogue(folder, packages)
    work = _Work(catalogue, iris, last, version, intact)
    writing = _Writing(transaction, iris, present, intact)
    launching = {key: number for key in sorted(packages) if (number := packages[key].counts.get("launches", 0))}
    fresh = {key: number for key, number in launching.items() if work.is_fresh(key)}
    if fresh and pool is not None and pool.size > 1 and not strangers:
        for key, found, marks in wired_by(pool, fresh, folder, iris, packages):
            catalogue.learn(marks)
            work.adopt(key, packages[key].result, found)
            writing.take(work.taken())
    for key in launching:
        if not work.has(key):
            work.package(folder, key, packages[key].result)
            writing.take(work.taken())
    sources = {source for source, _ in packages} | set(last.packages)
    prefixes = tuple(iris.launch_graph(source, "") for source in sources)
    gone = [graph for graph in sorted(present) if prefixes and graph.startswith(prefixes) and graph not in work.graphs]
    writing.take(dict.fromkeys(gone, b""))
    writing.finish()
    systems = work.systems()
    return systems, replace(totals(systems), changed=writing.changed, failed=tuple(work.failed))


def _strangers(iris: Iris, packages: Mapping[Key, PackageState], present: set[str]) -> bool:
    """Return whether the store has sources without cached results."""
    own = (iris.source_graph(source) for source, _ in packages)
    return any(graph.startswith(iris.source_graph("")) for graph in present.difference(own))


def _with_strangers(transaction: EmbeddedTransaction, folder: Path, packages: Mapping[Key, PackageState]) -> Catalogue:
    """Return the node types of the store; those of sources without cached results are read from their graphs."""
    own = {source for source, _ in packages}
    others = [record for record in node_records(transaction) if record.repository not in own]
    data = [file for file in data_files(transaction) if file.repository not in own]
    return Catalogue(folder, packages, others, programs(transaction), data)


class _Writing:
    """Writes graphs of systems in batches to limit memory; `changed` counts them."""

    def __init__(self, transaction: EmbeddedTransaction, iris: Iris, present: set[str], intact: set[str]) -> None:
        self.changed = 0
        self._transaction = transaction
        self._iris = iris
        self._present = present
        self._intact = intact
        self._read = bool(intact) and iris.graph(STARTS) in present
        """Whether all replaced graphs, and that of starts, had the content of the last build."""
        self._waiting: dict[NamedNode, bytes] = {}
        self._bytes = 0
        self._starts = Described(transaction.layout.cache)
        self._gone: list[bytes] = []
        self._came: list[bytes] = []

    def take(self, contents: Mapping[str, bytes]) -> None:
        """Replace the content of graphs by N-Triples, and remove graphs with empty content.

        Graphs in `intact` have most of their new content already; the content of others is unknown and counts as empty.
        """
        for name, content in contents.items():
            own, described = starts_apart(content, self._iris)
            self._starts.add(described)
            self._give(name, own)
            self._read = self._read and (name not in self._present or name in self._intact)
        self.changed += len(contents)
        if self._bytes > _BATCH_BYTES:
            self._flush()

    def _give(self, name: str, content: list[bytes]) -> None:
        graph, wanted = NamedNode(name), set(content)
        stored = (
            set(self._transaction.content(graph).splitlines(keepends=True)) if name in self._intact else set[bytes]()
        )
        removed, added = stored - wanted, wanted - stored
        if self._read:
            self._gone += filter(_starts_something, removed)
            self._came += filter(_starts_something, added)
        if not wanted:
            self._transaction.drop_graph(graph)
        elif (len(removed) + len(added)) * _SMALL > len(wanted):
            self._waiting[graph] = b"".join(content)
            self._bytes += len(self._waiting[graph])
        else:
            self._transaction.patch_graph(graph, b"".join(sorted(removed)), b"".join(sorted(added)))

    def _flush(self) -> None:
        self._transaction.replace_small_graphs(self._waiting)
        self._waiting, self._bytes = {}, 0

    def finish(self) -> None:
        """Write the waiting graphs, and the start records of the systems."""
        give_back()
        if self._waiting:
            self._flush()
        if self.changed:
            keep_starts(self._transaction, self._iris, self._starts, (self._gone, self._came) if self._read else None)
        self._starts.close()


def _starts_something(line: bytes) -> bool:
    return _STARTED_WITH in line


def used_packages(configurations: Iterable[LaunchConfiguration]) -> set[str]:
    """Return the names of the packages whose nodes launch files start."""
    names: set[str] = set()
    for configuration in configurations:
        for node in configuration.nodes:
            names.add(node.package or "")
            names.add((node.plugin or "").partition("/")[0].partition("::")[0])
    return names - {""}


def node_types(graph: Queryable, packages: Iterable[str]) -> tuple[NodeTypes, dict[NodeReference, NodeRecord]]:
    """Return the node types of some packages, their records by reference, and other programs of all packages."""
    records = node_records(graph, packages=packages)
    pairs = [(record.reference, record.node) for record in records]
    types = NodeTypes(pairs, programs=programs(graph), data=data_files(graph))
    return types, {record.reference: record for record in reversed(records)}


class _Work:
    """The systems of one build; `graphs` contains the remaining ones."""

    def __init__(self, catalogue: Catalogue, iris: Iris, last: Systems, version: str, intact: set[str]) -> None:
        self.graphs: set[str] = set()
        self._contents: dict[str, bytes] = {}
        self.failed: list[str] = []
        """Launch files that could not be wired, with the reason."""
        self._catalogue = catalogue
        self._iris = iris
        self._last = last
        self._version = version
        self._intact = intact
        self._questions = [question for question, _ in last.answers]
        answers = enumerate(last.answers if last.version == version else ())
        self._changed = {at for at, (question, mark) in answers if catalogue.mark(question) != mark}
        self._current: dict[Key, dict[str, WiredSystem]] = {}
        self._lookups: dict[Question, int] = {}
        """Look-ups of the systems in `_found`, each with its index there."""
        self._results: dict[Key, str] = {}

    def package(self, folder: Path, key: Key, result: str) -> None:
        """Wire the changed systems of a package; `result` is the name of its result in the cache `folder`."""
        earlier = self._last.packages.get(key[0], {}).get(key[1])
        valid = {path: one for path, one in earlier.graphs.items() if self._holds(key, path, one)} if earlier else {}
        systems = {path: self._numbered(one, (self._questions[at] for at in one.asked)) for path, one in valid.items()}
        if earlier is None or earlier.result != result or len(valid) < len(earlier.graphs):
            configurations = {one.path: one for one in cache.launches(folder, result) or ()}
            rewired = {path: one for path, one in systems.items() if path in configurations}
            systems = {
                path: rewired[path]
                if path in rewired and rewired[path].configuration == mark_of(configuration)
                else self._kept(key, wired(configuration, self._catalogue, self._iris), earlier)
                for path, configuration in configurations.items()
            }
        self._set(key, result, systems)

    def is_fresh(self, key: Key) -> bool:
        """Return whether no system of a package can be that of the last build."""
        return self._last.version != self._version or key[1] not in self._last.packages.get(key[0], {})

    def has(self, key: Key) -> bool:
        """Return whether the systems of a package are known."""
        return key in self._current

    def adopt(self, key: Key, result: str, systems: Iterable[Wired]) -> None:
        """Take the systems of a package as others have wired them."""
        earlier = self._last.packages.get(key[0], {}).get(key[1])
        self._set(key, result, {one.path: self._kept(key, one, earlier) for one in systems})

    def taken(self) -> dict[str, bytes]:
        """Return the graphs with new content since the last call."""
        contents, self._contents = self._contents, {}
        return contents

    def _set(self, key: Key, result: str, systems: dict[str, WiredSystem]) -> None:
        self._current[key], self._results[key] = systems, result
        self.graphs.update(self._iris.launch_graph(key[0], path) for path in systems)

    def _holds(self, key: Key, path: str, system: WiredSystem) -> bool:
        same = self._last.version == self._version and self._changed.isdisjoint(system.asked)
        return same and self._iris.launch_graph(key[0], path) in self._intact

    def _numbered(self, system: WiredSystem, questions: Iterable[Question]) -> WiredSystem:
        """Return a system with the indices of the look-ups of its wiring."""
        return replace(system, asked=tuple(self._lookups.setdefault(one, len(self._lookups)) for one in questions))

    def _kept(self, key: Key, system: Wired, earlier: PackageSystems | None) -> WiredSystem:
        """Return the state of a system; its graph is to be written if it differs from that of the last build."""
        graph = self._iris.launch_graph(key[0], system.path)
        before = earlier.graphs.get(system.path) if earlier else None
        if graph not in self._intact or before is None or before.graph != system.graph:
            self._contents[graph] = system.content
        if system.failed:
            self.failed.append(system.failed)
        return self._numbered(WiredSystem(system.configuration, system.graph, system.instances, ()), system.asked)

    def systems(self) -> Systems:
        """Return the state for the next build."""
        questions, places = list(self._lookups), dict[int, int]()
        packages: dict[str, dict[str, PackageSystems]] = {}
        for key, systems in sorted(self._current.items()):
            graphs = {}
            for path, system in sorted(systems.items()):
                at = tuple(sorted(places.setdefault(number, len(places)) for number in system.asked))
                graphs[path] = replace(system, asked=at)
            packages.setdefault(key[0], {})[key[1]] = PackageSystems(self._results[key], graphs)
        answers = tuple((questions[number], self._catalogue.mark(questions[number])) for number in places)
        return Systems(self._version, answers, packages)
