"""The whole build: plan, read changed packages, write one new generation of the store.

    store = EmbeddedStore.create(Path(".kg"))
    report = build(["~/catkin_ws/src"], store, settings.load(), Report())

If a build is killed or interrupted, the store is unchanged: it is written in one transaction at the end, and the state
for the next build is written last.
"""

from __future__ import annotations

import gc
import os
import time
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from kg.corpus.sources import is_address
from kg.errors import SourceError
from kg.graph.iris import Iris
from kg.graph.shared import SHARED
from kg.lazily import lazily
from kg.pipeline import cache
from kg.pipeline.calls import checked_calls
from kg.pipeline.inferring import Inference, Inferred
from kg.pipeline.plan import Key, Plan, code_bytes, code_version, entries_by_name, listing, make_plan, stamp, version
from kg.pipeline.reasoning import digest
from kg.pipeline.recording import RecordingWorkspace
from kg.pipeline.report import BuildReport, Report, SourceReport, SystemsReport, totals
from kg.pipeline.sources import LostSourceError, folders, gather, installed_folders
from kg.pipeline.state import PackageState, SourceState, State, Systems, load, save
from kg.store.allocator import share_pools
from kg.store.changes import since
from kg.store.failure import translated

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.corpus.fetching.lock import Entry
    from kg.corpus.files import Pin
    from kg.corpus.workspace import PackageFolder, Source
    from kg.pipeline.corpus import Corpus
    from kg.pipeline.work import Outcome
    from kg.pipeline.writing import Written
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction

with lazily():
    from kg.language.annotating import prepare
    from kg.pipeline.artifacts import Artifacts
    from kg.pipeline.cluster import ClusterPool, batches
    from kg.pipeline.corpus import connected
    from kg.pipeline.extracting import Request
    from kg.pipeline.pool import Pool, Task
    from kg.pipeline.systems import update_systems
    from kg.pipeline.work import Job
    from kg.pipeline.writing import Writing, untouched

_GC_THRESHOLD = 100_000
"""Number of new objects that triggers a garbage collection."""


def build(  # noqa: PLR0913 - each is a decision of the caller
    named: Sequence[str],
    store: EmbeddedStore,
    settings: Settings,
    report: Report | None = None,
    command: str = "kg build",
    *,
    rules: bool = True,
    pins: Mapping[str, Pin] = MappingProxyType({}),
) -> BuildReport:
    """Read the sources `named` (folders, git addresses, lists of them) into `store` and return a report.

    Without names it reads the sources of earlier builds. Other sources in the store remain. `report` receives the
    progress; `command` is the running command in errors of other writers. The enabled rules run in the same
    transaction; unusable ones are left out and listed in the report. Without `rules` inferences are unchanged.

    Of the names, those in `pins` are folders that need not exist: workers of the cluster in the settings fetch these
    repositories. One that cannot be fetched is left out as a whole; its graph of an earlier build remains.

    Raises:
        RuleError: KG208 for a rule pack that cannot be loaded, KG231 for an unreadable folder of rules.
        SourceError: KG101, KG102, KG103 if a source cannot be read at all, KG110, KG123, KG124 for an error in a
            description of framework calls; as `kg.pipeline.cluster.ClusterPool` with a cluster, KG133 if none of `pins`
            was fetched.
        UsageError: KG002 if a path of the settings does not exist, KG141, KG142 if the spaCy pipeline of the settings
            is unusable.
        StoreError: KG302 while another process writes, KG304 if the disk is full; the store is unchanged.
    """
    began = time.perf_counter()
    progress = report or Report()
    share_pools()
    with translated(str(store.layout.root)):
        store.layout.cache.mkdir(parents=True, exist_ok=True)
    cluster: AbstractContextManager[Corpus | None] = nullcontext()
    if settings.cluster:
        cluster = connected(settings.cluster, progress, pins)
    with _rare_collections(), cluster as corpus:
        while True:
            try:
                with store.write(command) as transaction:
                    running = _Build(store, transaction, settings, progress, rules=rules, corpus=corpus)
                    report_of_run = running.run(tuple(named))
                break
            except LostSourceError as error:  # nothing was written; what was read is found again
                if corpus is None:
                    raise
                corpus.leave_out(error.folder, str(error))
    finished = replace(report_of_run, seconds=time.perf_counter() - began)
    progress.finished(finished)
    return finished


@contextmanager
def _rare_collections() -> Iterator[None]:
    """Collect garbage less often: nearly all objects of a build live until its end, or are in no cycle."""
    before = gc.get_threshold()
    gc.set_threshold(_GC_THRESHOLD)
    try:
        yield
    finally:
        gc.set_threshold(*before)


class _Build:
    """State of a running build."""

    def __init__(  # noqa: PLR0913 - called in one place
        self,
        store: EmbeddedStore,
        transaction: EmbeddedTransaction,
        settings: Settings,
        report: Report,
        *,
        rules: bool,
        corpus: Corpus | None,
    ) -> None:
        self._corpus = corpus
        self._store = store
        self._transaction = transaction
        self._settings = settings
        self._report = report
        self._cache = store.layout.cache
        self._state = load(self._cache)
        self._jobs = settings.jobs or os.cpu_count() or 1
        self._started = datetime.now(UTC)
        self._rules = digest(settings, self._cache) if rules else None
        self._inference = Inference(store, settings)

    def run(self, named: tuple[str, ...]) -> BuildReport:
        """Run the build; the caller holds the lock of the store."""
        if not named and not self._state.roots:
            raise SourceError("KG101", "no source is named, and no earlier build named one", hint="Name a folder.")
        unfetched: tuple[Entry, ...] = ()
        if self._corpus is not None:
            self._corpus.fetch()
            unfetched = tuple(self._corpus.failed.values())
            named = tuple(one for one in named if one not in self._corpus.failed)
        roots = named or self._state.roots
        sources = gather(roots, self._store.layout.checkouts, self._report, again=not named, elsewhere=self._elsewhere)
        workspace = RecordingWorkspace(sources, installed_folders(self._settings))
        now = version(self._settings, self._cache)
        calls = checked_calls(self._settings)  # after the version: a file that changes in between is read again
        plan = make_plan(workspace, self._state, self._cache, now, self._settings.max_file_bytes)
        self._jobs = max(1, min(self._jobs, len(plan.read)))
        self._report.planned(len(plan.read), len(plan.reused), 0 if self._settings.cluster else self._jobs)
        results = dict(plan.reused)
        changed, gone = self._changed(sources, plan), self._removed_sources(sources, roots)
        written: dict[str, Written] = {}
        # The store is loaded after the workers have started, which must not inherit an open engine.
        with self._pool(workspace, plan, calls) if changed or gone else nullcontext() as pool:
            if changed or gone:
                written = self._write(workspace, plan, pool, changed, gone, results)
            if self._rules is None or self._state.version != now or self._transaction.base is None:
                self._inference.update_ontologies(self._transaction, anew=self._state.version != now)
            systems, wired = self._wire(sources, results, gone, now, pool, changed=bool(changed or gone))
        self._transaction.release()
        inferred = self._infer(changed=bool(changed or gone))
        generation = self._transaction.commit()
        self._inference.remember(generation)
        if inferred is not None:
            self._rules = self._inference.digest
        state = self._next_state(sources, plan, results, written, generation, named)
        state = replace(
            state, sources={name: one for name, one in state.sources.items() if name not in gone}, systems=systems
        )
        if state != self._state:
            with translated(str(self._cache)):
                save(self._cache, state)
                packages = (one for source in state.sources.values() for one in source.packages.values())
                cache.keep_only(self._cache, (package.result for package in packages))
        reports = tuple(self._source_report(source, plan, results) for source in sources)
        return BuildReport(reports, generation, 0.0, self._jobs, gone, inferred, wired, unfetched)

    @property
    def _elsewhere(self) -> Mapping[str, Source]:
        """Sources whose files only workers have, by folder."""
        return self._corpus.sources if self._corpus is not None else {}

    def _wire(  # noqa: PLR0913 - called in one place
        self,
        sources: Sequence[Source],
        results: dict[Key, PackageState],
        gone: tuple[str, ...],
        now: str,
        pool: Pool | ClusterPool | None,
        *,
        changed: bool,
    ) -> tuple[Systems, SystemsReport]:
        """Write the systems of launch files, for the sources of this build and the remaining ones."""
        built = {source.repository.name for source in sources}
        others = {name: one for name, one in self._state.sources.items() if name not in {*built, *gone}}
        packages = {
            **results,
            **{(name, path): one for name, source in others.items() for path, one in source.packages.items()},
        }
        beginning = f"{self._settings.base}graph/launch/"
        touched = self._touched
        if not changed and touched is not None and not any(graph.startswith(beginning) for graph in touched):
            return self._state.systems, totals(self._state.systems)
        return update_systems(
            self._transaction,
            self._cache,
            Iris(self._settings.base),
            packages,
            self._state.systems,
            now,
            touched=touched,
            pool=pool if pool is not None and isinstance(pool, Pool) else None,
        )

    def _infer(self, *, changed: bool) -> Inferred | None:
        """Run the rules if the sources or the rules have changed since the last run."""
        current = self._store.layout.current()
        if self._rules is None or (not changed and self._rules == self._state.rules and current is not None):
            return None
        self._report.inferring()
        inferred = self._inference.run(self._transaction)
        if not changed and not inferred.added and not inferred.removed:
            self._transaction.roll_back()
        return inferred

    def _changed(self, sources: Sequence[Source], plan: Plan) -> list[Source]:
        """Return the sources whose graph differs from its new content."""
        trusted = self._trusted(sources, plan)
        read = {source.repository.name for source, _ in plan.read}
        changed = []
        for source in sources:
            name = source.repository.name
            earlier = self._state.sources.get(name)
            if earlier is None or name in read or name not in trusted:
                changed.append(source)
                continue
            now = source.repository, source.problems, {package.path for package in source.packages}
            if now != (earlier.repository, earlier.problems, set(earlier.packages)):
                changed.append(source)
        return changed

    def _removed_sources(self, sources: Sequence[Source], roots: Sequence[str]) -> tuple[str, ...]:
        """Return the sources of earlier builds in the folders of this one that no longer exist."""
        present = {source.repository.name for source in sources}
        elsewhere = self._elsewhere
        inside = (*elsewhere, *folders(one for one in roots if one not in elsewhere))
        return tuple(
            name
            for name, earlier in self._state.sources.items()
            if name not in present and any(f"{earlier.repository.root}/".startswith(f"{folder}/") for folder in inside)
        )

    def _trusted(self, sources: Sequence[Source], plan: Plan) -> set[str]:
        """Return the sources whose graph in the store is unchanged since the last build."""
        current = self._store.layout.current()
        if self._state.version != plan.version or current is None:
            return set()
        names = {source.repository.name for source in sources} & set(self._state.sources)
        touched, iris = self._touched, Iris(self._settings.base)
        if touched is not None:
            return {name for name in names if iris.source_graph(name) not in touched}

        return untouched(self._store, self._settings.base, {name: self._state.sources[name] for name in names})

    @cached_property
    def _touched(self) -> frozenset[str] | None:
        """The graphs written since the last build saved its state, None if unknown.

        A build killed after committing its generation counts as such a write.
        """
        current = self._store.layout.current()
        if current is None or current == self._state.generation:
            return frozenset()
        graphs = since(self._store.layout, self._state.generation, current).graphs
        return None if graphs is None else frozenset(graphs)

    def _write(  # noqa: PLR0913, PLR0917 - called in one place
        self,
        workspace: RecordingWorkspace,
        plan: Plan,
        pool: Pool | ClusterPool | None,
        changed: list[Source],
        gone: tuple[str, ...],
        results: dict[Key, PackageState],
    ) -> dict[str, Written]:
        """Read the packages of the plan into `results`, and write the graphs of the `changed` sources."""
        self._jobs = pool.size if pool else self._jobs
        trusted = self._trusted(workspace.sources, plan)
        self._inference.begin(self._transaction, watched=self._rules is not None)
        shared = Iris(self._settings.base).graph(SHARED)
        writing = Writing(
            self._transaction,
            self._cache,
            self._state,
            plan,
            self._settings.base,
            trusted,
            shared_intact=self._touched is not None and shared not in self._touched,
        )
        writing.begin(changed)
        writing.drop(gone)
        entries = entries_by_name(workspace.sources)
        places = {(source.repository.name, package.path): (source, package) for source, package in plan.read}
        for outcome in pool.outcomes() if pool else ():
            source, package = places[outcome.result.source, outcome.result.path]
            self._report.done(outcome.result)
            name = source.repository.name
            mark = stamp(workspace, name, package, outcome.inputs, entries)
            state = self._cache_result(package, outcome, mark)
            results[name, package.path] = state
            writing.add(source, state)
        self._report.writing(writing.triples)
        written = writing.finish(changed, results, self._started)
        self._transaction.release()
        return written

    def _pool(
        self, workspace: RecordingWorkspace, plan: Plan, calls: tuple[str, ...]
    ) -> AbstractContextManager[Pool | ClusterPool | None]:
        """Return the workers for the packages to read, None for none; the largest packages start first.

        So the workers finish at about the same time.
        """
        if not plan.read:
            return nullcontext()

        workspace.prepare()
        model = self._settings.nlp_model
        largest = sorted(plan.read, key=lambda place: -code_bytes(place[1]))
        tasks = [
            Task(source.repository.name, package.name, package.path, self._earlier(source, package, plan))
            for source, package in largest
        ]
        if self._corpus is not None:
            return self._cluster_pool(self._corpus, workspace, plan, tasks, calls)
        if model or (len(tasks) > 1 and not all(task.earlier for task in tasks)):
            # Once for all workers, which are forked, and those that take their places. The worker of a single package
            # loads it with the first text that needs tagging; if all were read before, most texts are already tagged.
            prepare(model)
        job = Job(workspace, self._settings.base, self._settings.max_file_bytes, model, self._cache, calls)
        return Pool(job, tasks, self._jobs)

    def _cluster_pool(
        self,
        corpus: Corpus,
        workspace: RecordingWorkspace,
        plan: Plan,
        tasks: list[Task],
        calls: tuple[str, ...],
    ) -> ClusterPool:
        """Return the workers of the cluster in the settings; raises as `kg.pipeline.cluster.ClusterPool`."""
        from kg.pipeline.pool import PACKAGE_SECONDS  # noqa: PLC0415 - a build without changes imports no reader

        settings = self._settings
        artifacts = Artifacts(settings.artifacts or str(self._cache / "artifacts"))
        job = Job(workspace, settings.base, settings.max_file_bytes, settings.nlp_model, calls=calls)
        name = artifacts.keep_job(plan.version, code_version(settings.nlp_model, self._cache), job)
        sizes = {(source.repository.name, package.path): code_bytes(package) for source, package in plan.read}
        work = batches((task, sizes[task.source, task.path]) for task in tasks)
        homes = {one.repository.name: corpus.homes[str(one.root)] for one in workspace.sources if one.pin}
        request = Request(artifacts.address, name, PACKAGE_SECONDS)
        return ClusterPool(corpus.cluster, work, request, artifacts, homes)

    def _earlier(self, source: Source, package: PackageFolder, plan: Plan) -> str:
        """Return the name of the last result of a package, if it has the same version."""
        source_state = self._state.sources.get(source.repository.name) if self._state.version == plan.version else None
        before = source_state.packages.get(package.path) if source_state else None
        return before.result if before else ""

    def _cache_result(self, package: PackageFolder, outcome: Outcome, mark: str) -> PackageState:
        """Cache a result and return its state for the next build."""
        with translated(str(self._cache)):
            name = cache.store(self._cache, outcome.packed)
        result = outcome.result
        return PackageState(
            name=result.name,
            path=result.path,
            listing=listing(package) if outcome.reusable else "",
            stamp=mark,
            inputs=outcome.inputs,
            outside=tuple(sorted(outcome.outside.items())),
            result=name,
            counts=dict(result.counts),
            unresolved=dict(result.unresolved),
            problems=result.problems,
            known=outcome.visible,
        )

    def _next_state(  # noqa: PLR0913, PLR0917 - the results of a build
        self,
        sources: Sequence[Source],
        plan: Plan,
        results: dict[Key, PackageState],
        written: dict[str, Written],
        generation: int | None,
        named: tuple[str, ...],
    ) -> State:
        sources_state = dict(self._state.sources) if self._state.version == plan.version else {}
        for source in sources:
            name = source.repository.name
            packages = {package.path: results[name, package.path] for package in source.packages}
            head, quads = written[name] if name in written else (sources_state[name].head, sources_state[name].quads)
            sources_state[name] = SourceState(
                source.repository, source.problems, packages, head, quads, source.pin is not None
            )
        here = [one for one in named if one not in self._elsewhere]
        absolute = (one if is_address(one) else str(Path(one).expanduser().absolute()) for one in here)
        roots = dict.fromkeys((*self._state.roots, *absolute))
        current = generation or self._store.layout.current() or 0
        return State(plan.version, plan.shape, current, tuple(roots), sources_state, self._rules or "")

    def _source_report(self, source: Source, plan: Plan, results: dict[Key, PackageState]) -> SourceReport:
        name = source.repository.name
        earlier = self._state.sources.get(name)
        present = {package.path for package in source.packages}
        read = sum(one.repository.name == name for one, _ in plan.read)
        return SourceReport(
            repository=source.repository,
            packages=tuple(results[name, package.path].report(name) for package in source.packages),
            read=read,
            reused=len(source.packages) - read,
            removed=len(set(earlier.packages) - present) if earlier else 0,
            problems=source.problems,
        )
