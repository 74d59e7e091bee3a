"""Run the enabled rules: inside the transactions of the pipeline, over a store, a SPARQL server or files.

Inferences change together with the asserted triples, in one transaction.

The ontologies are input of the rules: their graph is patched if one of their files has changed, before the rules run.

A failing rule never loses asserted triples. Unusable files are left out. If the others cannot run together, those of
the user's folders are left out too; if that does not help, nothing is inferred. So the graph of inferred triples always
corresponds to the rules that ran, and never contains triples from an earlier state of the data.
"""

from __future__ import annotations

import json
import os
import zlib
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import msgspec
from pyoxigraph import NamedNode, RdfFormat, Triple, parse

from kg.errors import GraphError, KgError, Place, RuleError, UsageError
from kg.graph.iris import Iris
from kg.graph.ontology_files import default_ontologies, ontologies_in_force, ontology_triples
from kg.graph.vocabulary import RNKG
from kg.lazily import lazily
from kg.pipeline import seed as seeds
from kg.pipeline.filecache import State, states, unless_changed
from kg.pipeline.reach import newly_asserted
from kg.pipeline.reasoning import digest, ontology_digest, rules_in_force, rules_over, schema_of
from kg.rules.dependencies import patterns
from kg.rules.recording import Names
from kg.rules.specialise import is_schema, specialised
from kg.store.failure import translated
from kg.store.files import opened
from kg.store.layout import Layout, write_atomically
from kg.store.opening import existing

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.rules.engine.limits import Limits
    from kg.rules.files import RuleSet
    from kg.rules.remote.running import RemoteReport
    from kg.rules.reports import RunReport
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction

with lazily():
    from kg.rules.remote.running import run as run_remotely
    from kg.rules.running import Runner, rdf_format, run_files
    from kg.rules.written import Written
    from kg.store.remote import RemoteStore

_LAST: Final = "rules"
"""Cache file with the record of the last run; below, that with the ontologies written to the store."""
_ONTOLOGIES: Final = "ontologies"
_MOST_UNREAD: Final = 16
"""After so many changes that reach no rule, a run takes them into the saved columns."""


@dataclass(frozen=True, slots=True)
class Inferred:
    """Result of rules: the number of inferred triples, and how many were added and removed.

    `mode` is full or incremental, or none if the rules could not run and nothing is inferred. `problems` contains the
    errors of the rules and ontologies that were left out.
    """

    triples: int
    added: int
    removed: int
    seconds: float
    mode: str
    problems: tuple[KgError, ...] = ()


@dataclass(frozen=True, slots=True)
class LastRun:
    """Record of the last run: the digest of its rules, empty if some could not run, and its counts.

    The inferences follow from the generation `generation` of the store and these rules, with this `base`. `costs` are
    those of the last full run: for each rule its seconds, the number of triples that it derived first, and its rounds.
    `patterns` are those of the rules (`kg.rules.dependencies.patterns`), empty if unknown. `unread` counts the latest
    changes that could reach none of them, so that nothing ran.
    """

    digest: str
    base: str = ""
    generation: int | None = None
    asserted: int = 0
    inferred: int = 0
    strata: int = 0
    costs: Mapping[str, tuple[float, int, int]] = field(default_factory=dict)
    patterns: Sequence[str] = ()
    unread: int = 0


def _noted(report: RunReport, rules: RuleSet, settings: Settings, cache: Path) -> LastRun:
    """Return the record of a run, still without digest and generation."""
    named = rules.patterns or patterns(rules.rules, rules.data)
    counts, costs = (report.asserted, report.inferred, report.strata), _costs(report, cache)
    return LastRun("", settings.base, None, *counts, costs, sorted(named))


def _costs(report: RunReport, cache: Path) -> Mapping[str, tuple[float, int, int]]:
    """Return the cost of each rule: in this run if it was full, else in the last full run."""
    if not report.rules:
        last = last_run(cache)
        return last.costs if last else {}
    costs: dict[str, tuple[float, int, int]] = {}
    for one in report.rules:
        seconds, derived, rounds = costs.get(one.rule.name, (0.0, 0, 0))
        total = round(seconds + one.seconds, 4)
        costs[one.rule.name] = (total, derived + one.derived, max(rounds, one.rounds))
    return costs


def last_run(cache: Path) -> LastRun | None:
    """Return the record of the last run in the folder `cache`; None if missing."""
    try:
        return LastRun(**json.loads((cache / _LAST).read_bytes()))
    except (OSError, ValueError, TypeError):
        return None


def _note_run(cache: Path, run: LastRun) -> None:
    """Save the record of a run for the next one; StoreError KG304 if the disk is full."""
    with translated(str(cache)):
        cache.mkdir(parents=True, exist_ok=True)
        write_atomically(cache / _LAST, json.dumps(asdict(run)).encode(), durable=False)


def unchanged(settings: Settings, layout: Layout) -> LastRun | None:
    """Return the last run if the store and the rules are unchanged since, so another one would do nothing.

    Raises as `digest`.
    """
    last = last_run(layout.cache)
    if last is None or last.generation != layout.current() or last.base != settings.base:
        return None
    return last if last.digest == digest(settings, layout.cache) else None


class _Ontologies(msgspec.Struct, frozen=True):
    """Ontologies as compressed N-Triples, with the digest of their files."""

    digest: str
    packed: bytes

    def content(self) -> bytes | None:
        """Return the N-Triples; None if they are damaged."""
        with suppress(zlib.error):
            return zlib.decompress(self.packed)
        return None


def _written_ontologies(cache: Path) -> _Ontologies | None:
    """Return the ontologies written to the store; None if unknown."""
    with suppress(OSError, msgspec.DecodeError):
        return msgspec.msgpack.decode((cache / _ONTOLOGIES).read_bytes(), type=_Ontologies)
    return None


def _in_force(settings: Settings, problems: list[KgError] | None) -> bytes:
    files = ontologies_in_force(settings)
    seen = tuple(state for file in files for state in states(file))
    try:
        return unless_changed(_triples, files, seen=seen)
    except GraphError:
        if problems is None:
            raise
    readable = []
    for file in files:
        try:
            ontology_triples([file])
            readable.append(file)
        except GraphError as error:
            problems.append(error)
    return ontology_triples(readable)


@lru_cache(maxsize=1)
def _triples(files: tuple[Path, ...], _seen: tuple[State, ...]) -> bytes:
    """Return the ontologies as N-Triples, cached in this process for other stores."""
    return ontology_triples(files)


class Inference:
    """The enabled rules, run inside a transaction; `remember` after the commit speeds up the next run.

    A long-running process can run them repeatedly, in successive transactions. `digest` is that of the rules that ran,
    empty before the run, and if some could not.
    """

    def __init__(self, store: EmbeddedStore, settings: Settings) -> None:
        self.digest = ""
        self._store = store
        self._settings = settings
        self._runner: Runner | None = None
        self._last: LastRun | None = None
        self._ontologies: _Ontologies | None = None
        """Ontologies that the transaction wrote to the store; None if it did not."""

    def prepare(self) -> None:
        """Load the enabled rules and the memory of their last run in advance, before the first transaction.

        Raises as `run`, and StoreError as `EmbeddedStore.read`.
        """
        with self._store.read() as snapshot:
            rules = rules_over(self._settings, snapshot, [], cache=self._store.layout.cache)
        self._runner = _new_runner(self._store, self._settings)
        self._runner.prepare(rules)

    def watch(self, transaction: EmbeddedTransaction) -> None:
        """Retain the triples that a transaction writes into an empty store, so the rules need not read them back."""
        if transaction.base is None and not transaction.changed:
            transaction.changes = Written(self._store.layout.cache)

    def begin(self, transaction: EmbeddedTransaction, *, watched: bool) -> None:
        """Let an empty store begin with the ontologies that `kg` brings along; `watched` if rules will run.

        Raises UsageError KG002 for a folder or file of the settings that does not exist.
        """
        settings = self._settings
        if watched:
            self.watch(transaction)
        if transaction.base is not None or ontologies_in_force(settings) != default_ontologies():
            return
        mark, graph, written = ontology_digest(settings, self._store.layout.cache), self._ontology, transaction.changes
        key = seeds.key_of(mark, graph)
        seed = seeds.load(key)
        if seed is not None:
            transaction.start_with(seed.files)
            self._ontologies = _Ontologies(mark, seed.packed)
            if isinstance(written, Written):
                written.begin(graph.value, seed.terms, seed.columns)
            else:
                written.replace(graph.value)
        elif isinstance(written, Written):
            self.update_ontologies(transaction)
            if self._ontologies is not None:
                seeds.save(key, seeds.Seed(transaction.files(), *written.so_far(graph.value), self._ontologies.packed))

    @property
    def _ontology(self) -> NamedNode:
        """The graph of the ontologies."""
        return NamedNode(Iris(self._settings.base).graph("ontology"))

    def outdated(self) -> bool:
        """Return whether the ontologies in the settings differ from those in the store; raises KG002."""
        cache = self._store.layout.cache
        given = _written_ontologies(cache)
        return given is not None and given.digest != ontology_digest(self._settings, cache)

    def update_ontologies(
        self, transaction: EmbeddedTransaction, problems: list[KgError] | None = None, *, anew: bool = False
    ) -> None:
        """Write the ontologies to a store, if it has none or their files have changed.

        Triples that users added to their graph remain. So does a graph that users created, unless it is written `anew`.
        A file that cannot be read is left out and its error added to `problems`, if given.

        Raises:
            GraphError: KG601 for a file that cannot be read, without `problems`.
            UsageError: KG002 for a folder or file of the settings that does not exist.
        """
        if self._ontologies is not None:  # by `begin`
            return
        cache, graph = self._store.layout.cache, self._ontology
        given, present = _written_ontologies(cache), graph in transaction.graphs()
        digest_now = ontology_digest(self._settings, cache)
        if present and not anew and (given is None or given.digest == digest_now):
            return
        wanted = _in_force(self._settings, problems)
        self._ontologies = _Ontologies(digest_now, zlib.compress(wanted, level=1))
        if not present:
            transaction.load(graph, [wanted])
            return
        stored = (None if anew or given is None else given.content()) or transaction.content(graph)
        old, new = (set(content.splitlines(keepends=True)) for content in (stored, wanted))
        if old != new:
            transaction.patch_graph(graph, b"".join(old - new), b"".join(new - old))

    def run(self, transaction: EmbeddedTransaction) -> Inferred:
        """Update the inferences to the data written so far by the transaction; unusable rules are left out.

        Changed ontologies are updated first. Raises:
            RuleError: KG208 for a rule pack that cannot be loaded, KG231 for an unreadable folder of rules.
            UsageError: KG002 for a folder or a family of the settings that does not exist.
        """
        mark = digest(self._settings, self._store.layout.cache)
        if self._runner is None and (last := self._unread(transaction, mark)):
            self.digest, self._last = mark, last
            return Inferred(last.inferred, 0, 0, 0.0, "incremental")
        unreadable: list[KgError] = []
        if self.outdated():
            self.update_ontologies(transaction, unreadable)
        problems: list[RuleError] = []
        self._last = LastRun("")
        inferred = self._attempt(transaction, problems, mark, own=True)
        if inferred is None:
            inferred = self._attempt(transaction, [], mark, own=False) or self._nothing(transaction)
        self.digest = "" if problems or unreadable else mark
        self._last = replace(self._last, digest=self.digest)
        return replace(inferred, problems=(*unreadable, *problems))

    def _unread(self, transaction: EmbeddedTransaction, mark: str) -> LastRun | None:
        """Return the record of a run after a change that no rule can react to; None where rules have to run.

        The inferences have to follow from the generation before the change and the rules with the digest `mark`.
        """
        last = last_run(self._store.layout.cache)
        if last is None or not last.patterns or last.unread >= _MOST_UNREAD:
            return None
        if (last.digest, last.base, last.generation) != (mark, self._settings.base, transaction.base):
            return None
        names = Names.of(self._settings.base, RNKG)
        more = newly_asserted(transaction, names, frozenset(last.patterns))
        return None if more is None else replace(last, asserted=last.asserted + more, unread=last.unread + 1)

    def _attempt(
        self, transaction: EmbeddedTransaction, problems: list[RuleError], mark: str, *, own: bool
    ) -> Inferred | None:
        """Run the readable rules, whose digest is `mark`.

        If they cannot run, return None and add the error to `problems`.
        """
        runner = self._runner or _new_runner(self._store, self._settings)
        self._runner = None
        try:
            cache = self._store.layout.cache
            rules = rules_over(self._settings, transaction, problems, own=own, cache=cache, mark=mark)
            report = runner.run_within(transaction, rules)
        except RuleError as error:
            problems.append(error)
            return None
        self._runner = runner
        self._last = _noted(report, rules, self._settings, cache)
        return Inferred(report.inferred, report.added, report.removed, report.seconds.total, report.mode)

    def _nothing(self, transaction: EmbeddedTransaction) -> Inferred:
        """Remove all inferred triples."""
        graph = NamedNode(Iris(self._settings.base).graph("inferred"))
        removed = transaction.count(graph) if graph in transaction.graphs() else 0
        if removed:
            transaction.drop_graph(graph)
        return Inferred(0, 0, removed, 0.0, "none")

    def remember(self, generation: int | None, *, save: bool = True) -> None:
        """Store the input and output of the run in memory, for the generation that its transaction created.

        Without `save` they stay in this process; another process starts from the ones saved last.
        """
        if self._runner is not None:
            self._runner.remember(generation, save=save)
        if self._ontologies:
            cache = self._store.layout.cache
            with translated(str(cache)):
                cache.mkdir(parents=True, exist_ok=True)
                write_atomically(cache / _ONTOLOGIES, msgspec.msgpack.encode(self._ontologies), durable=False)
            self._ontologies = None
        if self._last is not None:
            current = generation or self._store.layout.current()
            _note_run(self._store.layout.cache, replace(self._last, generation=current))

    def save(self) -> None:
        """Write them to the cache."""
        if self._runner is not None:
            self._runner.save()


def _new_runner(store: EmbeddedStore, settings: Settings) -> Runner:
    return Runner(Names.of(settings.base, RNKG), store.layout.cache)


def run_on_store(
    settings: Settings, *, full: bool = False, dry_run: bool = False, limits: Limits | None = None
) -> RunReport:
    """Update the inferred triples of the current store from its other graphs; only with `full` from scratch.

    Changed ontologies are updated first. Raises:
        GraphError: KG601 for an ontology that cannot be read; the store is unchanged.
        RuleError: KG2xx for rules that cannot be read or run, KG205 at a limit; the store is unchanged.
        StoreError: KG301 without a store, KG302 while another process writes.
    """
    store, mark = existing(settings), digest(settings)
    inference = Inference(store, settings)
    if inference.outdated():
        rules, report = _run_with_ontologies(store, settings, inference, full=full, dry_run=dry_run, limits=limits)
        base = report.generation
    else:
        with store.read() as snapshot:
            rules, base = rules_over(settings, snapshot), snapshot.generation
        runner = _new_runner(store, settings)
        report = runner.run(store, rules, limits=limits, incremental=not full, dry_run=dry_run)
    if not dry_run:
        base = report.generation or base
        last = _noted(report, rules, settings, store.layout.cache)
        _note_run(store.layout.cache, replace(last, digest=mark, generation=base))
    return report


def _run_with_ontologies(  # noqa: PLR0913 - the arguments of `run_on_store`
    store: EmbeddedStore, settings: Settings, inference: Inference, *, full: bool, dry_run: bool, limits: Limits | None
) -> tuple[RuleSet, RunReport]:
    """Update the ontologies and run the rules in one transaction; return the rules too."""
    runner = _new_runner(store, settings)
    with store.write("kg rules run") as transaction:
        inference.update_ontologies(transaction)
        rules = rules_over(settings, transaction)
        report = runner.run_within(transaction, rules, limits=limits, incremental=not full)
        if dry_run:
            transaction.roll_back()
            return rules, replace(report, dry_run=True)
        generation = transaction.commit()
    runner.remember(generation)
    inference.remember(generation)
    return rules, replace(report, generation=generation)


def run_on_server(
    settings: Settings, query_address: str, update_address: str | None = None, *, limits: Limits | None = None
) -> RemoteReport:
    """Run the rules on a SPARQL 1.1 server; raises as `run_on_store`, and KG225 if the server fails."""
    store = RemoteStore(query_address, update_address)
    rules = specialised(rules_in_force(settings), schema_of(store.read()))
    return run_remotely(store, rules, inferred_graph=Names.of(settings.base, RNKG).inferred, limits=limits)


def run_on_files(
    settings: Settings, files: Sequence[Path], output: Path | None, *, limits: Limits | None = None
) -> RunReport:
    """Write the inferences from RDF files to `output`, or nowhere if None.

    Raises as `run_files`, and UsageError KG003 before the run if `output` is not writable.
    """
    if output is not None:
        _check_output(output)
    schema = [triple for file in files for triple in _schema(file)]
    return run_files(files, output, specialised(rules_in_force(settings), schema), limits=limits)


def _check_output(output: Path) -> None:
    folder = output.absolute().parent
    problem = None
    if not os.path.isdir(folder):  # noqa: PTH112 - False if unreadable, whereas Path raises
        problem = f"the folder {folder} does not exist"
    elif os.path.isdir(output):  # noqa: PTH112 - the same
        problem = "it is a folder"
    elif not os.access(folder, os.W_OK | os.X_OK):
        problem = f"the folder {folder} may not be written"
    if problem:
        raise UsageError("KG003", f"cannot be written: {problem}", place=Place(str(output)), hint="Name another file.")


def _schema(file: Path) -> Iterator[Triple]:
    """Yield the axioms of a file; for N-Triples, only candidate lines are parsed. Other errors are reported later."""
    kind = rdf_format(file)
    plain = kind == RdfFormat.N_TRIPLES
    with opened(file) as content:
        lines = content.read().splitlines(keepends=True)
    candidates = [line for line in lines if not plain or b"/owl#" in line or b"/rdf-schema#" in line]
    address = file.absolute().as_uri()
    try:
        triples = [quad.triple for quad in parse(b"".join(candidates), kind, base_iri=address, lenient=True)]
    except SyntaxError:
        return
    yield from (triple for triple in triples if is_schema(triple.predicate, triple.object))
