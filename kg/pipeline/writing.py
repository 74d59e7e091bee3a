"""Write the graphs of a build into the store.

If little of a source has changed, its graph is patched: triples only in its changed packages are removed, new ones
added. Otherwise it is written again, from the cache and, while packages are still being read, from finished results.
"""

from __future__ import annotations

import re
from collections import Counter
from datetime import UTC, datetime
from importlib.metadata import version as installed_version
from typing import TYPE_CHECKING, Final, NamedTuple

from pyoxigraph import NamedNode

from kg.errors import Place, StoreError
from kg.graph import vocabulary as v
from kg.graph.builds import BuildRecord, Counts, build_triples
from kg.graph.iris import Iris
from kg.graph.packages import repository_triples
from kg.pipeline import cache
from kg.pipeline.sharing import keep_shared, patch_shared
from kg.pipeline.state import PackageState, SourceState, State, discard

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kg.corpus.workspace import Source
    from kg.pipeline.plan import Key, Plan
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction

_FLUSH_BYTES: Final = 4 << 20
"""Size of the waiting content of all sources after which it is written."""
_OWN: Final = re.compile(f" (?:{re.escape(v.BYTES)}|{re.escape(v.DIGEST)}) ".encode())
"""Properties of a file stated only by its own package."""
_SMALL: Final = 10
"""A source is patched if less than this fraction of its packages and of its triples change (1/n)."""


class Written(NamedTuple):
    """N-Triples about a source itself in the store, and the number of triples of its graph."""

    head: str
    quads: int


class Writing:
    """Writes the graphs of changed sources; `triples` is the number of triples written."""

    def __init__(  # noqa: PLR0913, PLR0917 - created in one place, from all results of a build
        self,
        transaction: EmbeddedTransaction,
        folder: Path,
        state: State,
        plan: Plan,
        base: str,
        trusted: set[str],
        *,
        shared_intact: bool = False,
    ) -> None:
        self._transaction = transaction
        self._folder = folder
        self._state = state
        self._plan = plan
        self._iris = Iris(base)
        self._trusted = trusted
        self._shared_intact = shared_intact
        self._patched: set[str] = set()
        self._dropped: set[str] = set()
        self._waiting: dict[NamedNode, list[bytes]] = {}
        self._waiting_bytes = 0
        self.triples = 0

    def begin(self, changed: list[Source]) -> None:
        """Decide how to write each source, and clear the graphs of those that are written again."""
        self._patched = {source.repository.name for source in changed if self._is_small(source)}
        rewritten = [source for source in changed if source.repository.name not in self._patched]
        if not rewritten and self._state.version == self._plan.version:
            return
        self._transaction.replace_graphs({self._graph(source.repository.name): () for source in rewritten})
        for source in rewritten:
            name = source.repository.name
            for package in source.packages:
                reused = self._plan.reused.get((name, package.path))
                if reused:
                    self._take(name, self._content(reused))

    def drop(self, names: tuple[str, ...]) -> None:
        """Remove the graphs of sources that no longer exist."""
        self._dropped.update(names)
        for name in names:
            self._transaction.drop_graph(self._graph(name))

    def add(self, source: Source, package: PackageState) -> None:
        """Add a package that was read; those of patched sources wait for `finish`."""
        name = source.repository.name
        if name not in self._patched:
            self._take(name, self._content(package))

    def finish(
        self, changed: list[Source], results: Mapping[Key, PackageState], started: datetime
    ) -> dict[str, Written]:
        """Write the rest of each source, and the record of its build; return the resulting content."""
        heads = [repository_triples(source.repository, self._iris, source.problems) for source in changed]
        for source, head in zip(changed, heads, strict=True):
            if source.repository.name not in self._patched:
                self._take(source.repository.name, head)
        self._flush()
        written = {}
        for source, head in zip(changed, heads, strict=True):
            name = source.repository.name
            if name in self._patched:
                quads = self._state.sources[name].quads + self._patch(source, head, results)
            else:
                quads = self._transaction.count(self._graph(name))
            written[name] = Written(head.decode(), quads)
            packages = [results[name, package.path] for package in source.packages]
            self._record(source, packages, written[name].quads, started)
        self._share(changed, results)
        return written

    def _share(self, changed: list[Source], results: Mapping[Key, PackageState]) -> None:
        """Update the shared content of sources: of this build, and of the remaining sources of earlier builds."""
        built = {*(name for name, _ in results), *(source.repository.name for source in changed)}
        earlier = self._state.sources if self._state.version == self._plan.version else {}
        others = {name: one for name, one in earlier.items() if name not in built and name not in self._dropped}
        packages = [*results.values(), *(package for one in others.values() for package in one.packages.values())]
        before = {package.result: package for one in earlier.values() for package in one.packages.values()}
        after = {package.result: package for package in packages}
        if self._shared_intact and len(self._patched) == len(changed):
            gone = [shared_of(self._folder, one) for result, one in before.items() if result not in after]
            came = [shared_of(self._folder, one) for result, one in after.items() if result not in before]
            unchanged = (shared_of(self._folder, one) for result, one in after.items() if result in before)
            patch_shared(self._transaction, self._iris, gone, came, unchanged)
        else:
            contents = (shared_of(self._folder, package) for package in packages)
            keep_shared(self._transaction, self._iris, contents, {*built, *others})

    def _is_small(self, source: Source) -> bool:
        """Return whether so little of a source changed that its graph is patched."""
        name = source.repository.name
        earlier = self._state.sources.get(name)
        if earlier is None or name not in self._trusted:
            return False
        gone = self._stale_results(source, earlier)
        number = sum(one.repository.name == name for one, _ in self._plan.read)
        triples = sum(package.counts.get("triples", 0) for package in gone)
        return max(len(gone), number) * _SMALL < len(source.packages) and triples * _SMALL < earlier.quads

    def _stale_results(self, source: Source, earlier: SourceState) -> list[PackageState]:
        """Return the outdated earlier results."""
        name = source.repository.name
        return [package for path, package in earlier.packages.items() if (name, path) not in self._plan.reused]

    def _patch(self, source: Source, head: bytes, results: Mapping[Key, PackageState]) -> int:
        """Patch the graph of a source by the triples that differ; return by how many it grows."""
        name = source.repository.name
        earlier = self._state.sources[name]
        before = set(earlier.head.encode().splitlines(keepends=True))
        after = set(head.splitlines(keepends=True))
        for gone in self._stale_results(source, earlier):
            before.update(self._content(gone).splitlines(keepends=True))
        reused = []
        for package in source.packages:
            if (name, package.path) in self._plan.reused:
                reused.append(self._plan.reused[name, package.path])
            else:
                after.update(self._content(results[name, package.path]).splitlines(keepends=True))
        removed, added = before - after, after - before
        doubtful = {line for line in removed if not line.startswith(self._own(source)) and not _OWN.search(line)}
        for one in reused if doubtful else ():
            removed -= doubtful.intersection(self._content(one).splitlines(keepends=True))
        self.triples += len(removed) + len(added)
        self._transaction.patch_graph(self._graph(name), b"".join(sorted(removed)), b"".join(sorted(added)))
        return len(added) - len(removed)

    def _own(self, source: Source) -> tuple[bytes, ...]:
        """Return the beginnings of triples that only the packages being read can state."""
        repository, names = source.repository.name, Counter(package.name for package in source.packages)
        starts: list[str] = []
        for _, package in self._plan.read:
            if names[package.name] == 1:
                whole = self._iris.package(repository, package.name)
                starts += [f"<{whole}>", f"<{whole}#", f"<{self._iris.node(repository, package.name, 'x')[:-1]}"]
        return tuple(map(str.encode, starts))

    def _take(self, name: str, content: bytes) -> None:
        self._waiting.setdefault(self._graph(name), []).append(content)
        self.triples += content.count(b"\n")
        self._waiting_bytes += len(content)
        if self._waiting_bytes > _FLUSH_BYTES:
            self._flush()

    def _flush(self) -> None:
        """Write the waiting content, in few large pieces: the engine writes files for each index at every load."""
        if self._waiting:
            self._transaction.load_graphs(self._waiting)
        self._waiting, self._waiting_bytes = {}, 0

    def _content(self, package: PackageState) -> bytes:
        return _sound(self._folder, package, cache.triples(self._folder, package.result))

    def _graph(self, name: str) -> NamedNode:
        return NamedNode(self._iris.source_graph(name))

    def _record(self, source: Source, packages: list[PackageState], quads: int, started: datetime) -> None:
        """Add the record of reading one source to the graph `builds`."""
        keys = Counts.__dataclass_fields__
        totals = {key: sum(package.counts.get(key, 0) for package in packages) for key in keys}
        totals |= {"packages": len(packages), "triples": quads}
        totals["problems"] += len(source.problems)
        record = BuildRecord(
            source.repository, started, datetime.now(UTC), installed_version("kg-ros"), Counts(**totals)
        )
        self._transaction.append(NamedNode(self._iris.graph("builds")), build_triples(record, self._iris))


def shared_of(folder: Path, package: PackageState) -> bytes:
    """Return the N-Triples of a package that sources share; StoreError KG303 if its cached result is damaged."""
    return _sound(folder, package, cache.shared(folder, package.result))


def _sound(folder: Path, package: PackageState, content: bytes | None) -> bytes:
    if content is None:
        discard(folder)
        message = f"the cached result of the package {package.name} is damaged"
        raise StoreError("KG303", message, place=Place(str(folder)), hint="Build again to read it again.")
    return content


def untouched(store: EmbeddedStore, base: str, sources: Mapping[str, SourceState]) -> set[str]:
    """Return those of `sources` whose graphs have the same size as after the last build."""
    iris = Iris(base)
    with store.read() as snapshot:
        sizes = {name: snapshot.count(NamedNode(iris.source_graph(name))) for name in sources}
    return {name for name, source in sources.items() if sizes[name] == source.quads}
