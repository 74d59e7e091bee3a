"""Rules inside the transactions of the pipeline: inferences change together with the asserted triples.

The ontologies belong to the rules: their graph is patched where a file of theirs changed, and the rules follow.

A failing rule never loses the triples that were read. An unusable file is left out. If the others cannot run together,
those of the user's folders are left out too; if that does not help, nothing is inferred. So the graph of inferred
triples always follows from the rules that ran, and never holds triples from an earlier state of the data.
"""

from __future__ import annotations

import json
import zlib
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from hashlib import blake2b
from typing import TYPE_CHECKING, Final

import msgspec
from pyoxigraph import NamedNode

from kg import resources
from kg.errors import GraphError, RuleError
from kg.graph.iris import Iris
from kg.graph.ontology_files import ontologies_in_force, ontology_triples
from kg.graph.vocabulary import RNKG
from kg.pipeline.kept import installations, kept, settled, states
from kg.pipeline.report import Inferred
from kg.rules.folders import families_in_force, user_folders
from kg.rules.reading import packs, rule_files
from kg.store.failure import translated
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kg.errors import KgError
    from kg.pipeline.kept import State
    from kg.rules.reading import Pack
    from kg.rules.reports import RunReport
    from kg.rules.running import Runner
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.layout import Layout
    from kg.store.transaction import EmbeddedTransaction

__all__ = [
    "Inference",
    "LastRun",
    "costs",
    "digest",
    "installed_packs",
    "last_run",
    "note_run",
    "unchanged",
]

_LAST: Final = "rules"
_DIGEST: Final = "rules-digest"
"""The file of the cache in which the digest of the rules is kept, and the next one for whether there are packs."""
_PACKS: Final = "packs"
_ONTOLOGIES: Final = "ontologies"
"""The file with the ontologies that the store was given and their digest, and the one in which that digest is kept."""
_ONTOLOGY_DIGEST: Final = "ontologies-digest"


def digest(settings: Settings, cache: Path | None = None) -> str:
    """Return a digest of all files of rules and ontologies in force.

    It is kept in the folder `cache` for the next process, if given.

    Raises:
        RuleError: KG208 for a pack that cannot be loaded, KG231 for a folder of rules that is closed.
        UsageError: KG002 for a folder or a family of the settings that does not exist.
    """
    folders = (resources.folder("rules"), *(pack.folder for pack in installed_packs(cache)), *user_folders(settings))
    seen, families = tuple(state for folder in folders for state in states(folder)), families_in_force(settings)
    made = _digest if settled(seen) else _digest.__wrapped__
    rules = kept(cache and cache / _DIGEST, seen, (families, folders), lambda: made(families, folders, seen))
    return f"{rules} {_ontology_digest(settings, cache)}"


def _ontology_digest(settings: Settings, cache: Path | None) -> str:
    """Return a digest of the ontologies in force; raises as `ontologies_in_force`."""
    files = ontologies_in_force(settings)
    seen = tuple(state for file in files for state in states(file))
    made = _digest_of if settled(seen) else _digest_of.__wrapped__
    return kept(cache and cache / _ONTOLOGY_DIGEST, seen, files, lambda: made(files, seen))


@lru_cache(maxsize=4)
def _digest_of(files: tuple[Path, ...], _seen: tuple[State, ...]) -> str:
    found = blake2b(digest_size=16)
    for file in files:
        found.update(f"{file.name}\0".encode())
        found.update(_content(file))
    return found.hexdigest()


def installed_packs(cache: Path | None = None) -> tuple[Pack, ...]:
    """Return the installed packs of rules; with a folder `cache`, without a search where the last one found none.

    Raises RuleError KG208 for a pack that cannot be loaded.
    """
    if cache is None:
        return packs()
    found = kept(cache / _PACKS, tuple(installations()), "", lambda: str(bool(packs())))
    return packs() if found == str(True) else ()


@lru_cache(maxsize=4)
def _digest(families: tuple[str, ...], folders: tuple[Path, ...], _seen: tuple[State, ...]) -> str:
    """Return the digest of the rules, read again only where the state of a file is another."""
    found = blake2b(repr(families).encode(), digest_size=16)
    for folder in folders:
        for path, name in rule_files(folder, families):
            found.update(f"{name}{path.suffix}\0".encode())
            found.update(_content(path))
    return found.hexdigest()


@dataclass(frozen=True, slots=True)
class LastRun:
    """Record of the last run: the digest of its rules, empty if some could not run, and its counts.

    What is inferred follows from the generation `generation` of the store and these rules, with this `base`. `costs`
    are those of the last full run: for each rule by name the seconds, the triples that it was the first to derive, and
    the rounds.
    """

    digest: str
    base: str = ""
    generation: int | None = None
    asserted: int = 0
    inferred: int = 0
    strata: int = 0
    costs: Mapping[str, tuple[float, int, int]] = field(default_factory=dict)


def costs(report: RunReport, cache: Path) -> Mapping[str, tuple[float, int, int]]:
    """Return the cost of each rule: in this run if it was full, else in the last full one."""
    if not report.rules:
        last = last_run(cache)
        return last.costs if last else {}
    found: dict[str, tuple[float, int, int]] = {}
    for one in report.rules:
        seconds, derived, rounds = found.get(one.rule.name, (0.0, 0, 0))
        total = round(seconds + one.seconds, 4)
        found[one.rule.name] = (total, derived + one.derived, max(rounds, one.rounds))
    return found


def last_run(cache: Path) -> LastRun | None:
    """Return the record of the last run in the folder `cache`; None if missing."""
    try:
        return LastRun(**json.loads((cache / _LAST).read_bytes()))
    except (OSError, ValueError, TypeError):
        return None


def note_run(cache: Path, run: LastRun) -> None:
    """Save the record of a run for the next one; StoreError KG304 when the disk is full."""
    with translated(str(cache)):
        cache.mkdir(parents=True, exist_ok=True)
        write_atomically(cache / _LAST, json.dumps(asdict(run)).encode(), durable=False)


def unchanged(settings: Settings, layout: Layout) -> LastRun | None:
    """Return the last run if neither the store nor a rule has changed since: another one would do nothing.

    Raises as `digest`.
    """
    found = last_run(layout.cache)
    if found is None or found.generation != layout.current() or found.base != settings.base:
        return None
    return found if found.digest == digest(settings, layout.cache) else None


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:  # reported where the file is read
        return str(error).encode()


class _Ontologies(msgspec.Struct, frozen=True):
    """Ontologies as N-Triples, with the digest of their files."""

    digest: str
    content: bytes


def _given(cache: Path) -> _Ontologies | None:
    """Return the ontologies that the store was given; None where that is not known."""
    with suppress(OSError, zlib.error, msgspec.DecodeError):
        return msgspec.msgpack.decode(zlib.decompress((cache / _ONTOLOGIES).read_bytes()), type=_Ontologies)
    return None


def _in_force(settings: Settings, problems: list[KgError] | None) -> bytes:
    files = ontologies_in_force(settings)
    if problems is None:
        return ontology_triples(files)
    readable = []
    for file in files:
        try:
            ontology_triples([file])
            readable.append(file)
        except GraphError as error:
            problems.append(error)
    return ontology_triples(readable)


class Inference:
    """The rules in force, run inside a transaction; `remember` after the commit makes the next run short.

    A long-running process can run them repeatedly, in one transaction after the other. `digest` is that of the
    rules that ran, empty before, and where some could not.
    """

    def __init__(self, store: EmbeddedStore, settings: Settings) -> None:
        self.digest = ""
        self._store = store
        self._settings = settings
        self._runner: Runner | None = None
        self._last: LastRun | None = None
        self._ontologies: _Ontologies | None = None
        """The ontologies that the transaction gave to the store; None where it left them alone."""

    def prepare(self) -> None:
        """Load the rules in force and the memory of their last run, for a process that waits for its first transaction.

        Raises as `run`, and StoreError as `EmbeddedStore.read`.
        """
        from kg.pipeline.reasoning import rules_over  # noqa: PLC0415 - numbers are loaded here

        with self._store.read() as snapshot:
            rules = rules_over(self._settings, snapshot, [], cache=self._store.layout.cache)
        self._runner = self._new_runner()
        self._runner.prepare(rules)

    def watch(self, transaction: EmbeddedTransaction) -> None:
        """Keep the triples that a transaction writes into an empty store: its run need not read them back."""
        from kg.rules.written import Written  # noqa: PLC0415 - numbers are loaded here

        if transaction.base is None and not transaction.changed:
            transaction.changes = Written()

    def outdated(self) -> bool:
        """Return whether the ontologies in force are others than those that the store was given; raises KG002."""
        cache = self._store.layout.cache
        given = _given(cache)
        return given is not None and given.digest != _ontology_digest(self._settings, cache)

    def update_ontologies(
        self, transaction: EmbeddedTransaction, problems: list[KgError] | None = None, *, anew: bool = False
    ) -> None:
        """Write the ontologies in force to a store: if it has none, or if their files have changed since.

        What users add to their graph stays. So does a graph that users made themselves, unless it is written `again`.
        A file that cannot be read is left out and its error added to `problems`, where they are given.

        Raises:
            GraphError: KG601 for a file that cannot be read, without `problems`.
            UsageError: KG002 for a folder or file of the settings that does not exist.
        """
        cache, graph = self._store.layout.cache, NamedNode(Iris(self._settings.base).graph("ontology"))
        given, present = _given(cache), graph in transaction.graphs()
        digest_now = _ontology_digest(self._settings, cache)
        if present and not anew and (given is None or given.digest == digest_now):
            return
        wanted = _in_force(self._settings, problems)
        self._ontologies = _Ontologies(digest_now, wanted)
        if not present:
            transaction.load(graph, [wanted])
            return
        held = transaction.content(graph) if anew or given is None else given.content
        old, new = (set(content.splitlines(keepends=True)) for content in (held, wanted))
        if old != new:
            transaction.patch_graph(graph, b"".join(old - new), b"".join(new - old))

    def _new_runner(self) -> Runner:
        from kg.rules.recording import Names  # noqa: PLC0415 - the same
        from kg.rules.running import Runner  # noqa: PLC0415 - the same

        return Runner(Names.of(self._settings.base, RNKG), self._store.layout.cache)

    def run(self, transaction: EmbeddedTransaction) -> Inferred:
        """Make what is inferred follow from what the transaction has written by now; what cannot run is left out.

        Ontologies whose files have changed are updated first. Raises:
            RuleError: KG208 for a pack that cannot be loaded, KG231 for a folder of rules that is closed.
            UsageError: KG002 for a folder or a family of the settings that does not exist.
        """
        found = digest(self._settings, self._store.layout.cache)
        unreadable: list[KgError] = []
        if self.outdated():
            self.update_ontologies(transaction, unreadable)
        problems: list[RuleError] = []
        self._last = LastRun("")
        inferred = self._attempt(transaction, problems, found, own=True)
        if inferred is None:
            inferred = self._attempt(transaction, [], found, own=False) or self._nothing(transaction)
        self.digest = "" if problems or unreadable else found
        self._last = replace(self._last, digest=self.digest)
        return replace(inferred, problems=(*unreadable, *problems))

    def _attempt(
        self, transaction: EmbeddedTransaction, problems: list[RuleError], mark: str, *, own: bool
    ) -> Inferred | None:
        """Run the rules that can be read, of the digest `mark`.

        Return None, and add the error to `problems`, where they cannot run.
        """
        # Numbers are loaded here, not where a build without changes ends.
        from kg.pipeline.reasoning import rules_over  # noqa: PLC0415 - see above

        runner = self._runner or self._new_runner()
        self._runner = None
        try:
            cache = self._store.layout.cache
            rules = rules_over(self._settings, transaction, problems, own=own, cache=cache, mark=mark)
            found = runner.run_within(transaction, rules)
        except RuleError as error:
            problems.append(error)
            return None
        self._runner = runner
        spent = costs(found, self._store.layout.cache)
        self._last = LastRun("", self._settings.base, None, found.asserted, found.inferred, found.strata, spent)
        return Inferred(found.inferred, found.added, found.removed, found.seconds.total, found.mode)

    def _nothing(self, transaction: EmbeddedTransaction) -> Inferred:
        """Remove all inferred triples."""
        graph = NamedNode(Iris(self._settings.base).graph("inferred"))
        removed = transaction.count(graph) if graph in transaction.graphs() else 0
        if removed:
            transaction.drop_graph(graph)
        return Inferred(0, 0, removed, 0.0, "none")

    def remember(self, generation: int | None, *, save: bool = True) -> None:
        """Keep the triples that the run read and inferred, as of the generation that its transaction made.

        Without `save` the columns stay in this process; the next one starts from those that were saved last.
        """
        if self._runner is not None:
            self._runner.remember(generation, save=save)
        if self._ontologies:
            cache = self._store.layout.cache
            with translated(str(cache)):
                cache.mkdir(parents=True, exist_ok=True)
                content = msgspec.msgpack.encode(self._ontologies)
                write_atomically(cache / _ONTOLOGIES, zlib.compress(content, level=1), durable=False)
            self._ontologies = None
        if self._last is not None:
            current = generation or self._store.layout.current()
            note_run(self._store.layout.cache, replace(self._last, generation=current))

    def save(self) -> None:
        """Write the memory to the cache."""
        if self._runner is not None:
            self._runner.save()
