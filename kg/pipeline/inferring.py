"""Rules inside the transactions of the pipeline: what is inferred changes together with what it is inferred from.

What was read is never lost for the sake of a rule. A file that cannot be used is left out. Where the others cannot run
together, those of the user's folders are left out too; where that does not help, nothing is inferred. So what stands
in the graph of inferred triples follows from the rules that ran, and is never left from an earlier state of the data.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from hashlib import blake2b
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg import resources
from kg.errors import RuleError
from kg.graph.iris import Iris
from kg.pipeline.report import Inferred
from kg.rules.folders import families_in_force, user_folders
from kg.rules.reading import packs, rule_files
from kg.store.failure import translated
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.running import Runner
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.layout import Layout
    from kg.store.transaction import EmbeddedTransaction

__all__ = ["Inference", "LastRun", "add_ontologies", "digest", "last_run", "note_run", "unchanged"]

_LAST: Final = "rules"


def digest(settings: Settings) -> str:
    """Return what changes whenever a file of a rule in force changes, comes or goes.

    Raises:
        RuleError: KG208 for a pack that cannot be loaded, KG231 for a folder of rules that is closed.
        UsageError: KG002 for a folder or a family of the settings that is not there.
    """
    families = families_in_force(settings)
    found = blake2b(repr(families).encode(), digest_size=16)
    for folder in (resources.folder("rules"), *(pack.folder for pack in packs()), *user_folders(settings)):
        for path, name in rule_files(folder, families):
            found.update(f"{name}{path.suffix}\0".encode())
            found.update(_content(path))
    return found.hexdigest()


@dataclass(frozen=True, slots=True)
class LastRun:
    """What is known of the last run: the digest of its rules, empty where some could not run, and what it counted.

    What is inferred follows from the generation `generation` of the store and these rules, with this `base`.
    """

    digest: str
    base: str = ""
    generation: int | None = None
    asserted: int = 0
    inferred: int = 0
    strata: int = 0


def last_run(cache: Path) -> LastRun | None:
    """Return what the last run left in the folder `cache`; None where it is not known."""
    try:
        return LastRun(**json.loads((cache / _LAST).read_bytes()))
    except (OSError, ValueError, TypeError):
        return None


def note_run(cache: Path, run: LastRun) -> None:
    """Keep what is known of a run for the next one; StoreError KG304 when the disk is full."""
    with translated(str(cache)):
        cache.mkdir(parents=True, exist_ok=True)
        write_atomically(cache / _LAST, json.dumps(asdict(run)).encode(), durable=False)


def unchanged(settings: Settings, layout: Layout) -> LastRun | None:
    """Return the last run where neither the store nor a rule has changed since, so that another one would do nothing.

    Raises as `digest`.
    """
    found = last_run(layout.cache)
    if found is None or found.generation != layout.current() or found.base != settings.base:
        return None
    return found if found.digest == digest(settings) else None


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:  # told where the rule is read
        return str(error).encode()


def add_ontologies(transaction: EmbeddedTransaction, settings: Settings) -> None:
    """Give a store the ontologies that rules read, where it has none yet, as the first build does."""
    from kg.graph.ontology_files import ontology_triples  # noqa: PLC0415 - only where they are missing

    graph = NamedNode(Iris(settings.base).graph("ontology"))
    if graph not in transaction.graphs():
        transaction.load(graph, [ontology_triples()])


class Inference:
    """The rules in force, run inside a transaction; `remember` when it is committed, so that the next run is short.

    `digest` is that of the rules that ran, empty before, and where some could not.
    """

    def __init__(self, store: EmbeddedStore, settings: Settings) -> None:
        self.digest = ""
        self._store = store
        self._settings = settings
        self._runner: Runner | None = None
        self._last: LastRun | None = None

    def run(self, transaction: EmbeddedTransaction) -> Inferred:
        """Make what is inferred follow from what the transaction has written by now; what cannot run is left out.

        Raises:
            RuleError: KG208 for a pack that cannot be loaded, KG231 for a folder of rules that is closed.
            UsageError: KG002 for a folder or a family of the settings that is not there.
        """
        found = digest(self._settings)
        problems: list[RuleError] = []
        self._last = LastRun("")
        inferred = self._attempt(transaction, problems, own=True)
        if inferred is None:
            inferred = self._attempt(transaction, [], own=False) or self._nothing(transaction)
        self.digest = "" if problems else found
        self._last = replace(self._last, digest=self.digest)
        return replace(inferred, problems=tuple(problems))

    def _attempt(self, transaction: EmbeddedTransaction, problems: list[RuleError], *, own: bool) -> Inferred | None:
        """Run the rules that can be read; None, and the error among `problems`, where they cannot run."""
        # Numbers are loaded here, not where a build without changes ends.
        from kg.graph.vocabulary import RNKG  # noqa: PLC0415 - see above
        from kg.pipeline.reasoning import rules_over  # noqa: PLC0415 - see above
        from kg.rules.recording import Names  # noqa: PLC0415 - see above
        from kg.rules.running import Runner  # noqa: PLC0415 - see above

        runner = Runner(Names.of(self._settings.base, RNKG), self._store.layout.cache)
        try:
            found = runner.run_within(transaction, rules_over(self._settings, transaction, problems, own=own))
        except RuleError as error:
            problems.append(error)
            return None
        self._runner = runner
        self._last = LastRun("", self._settings.base, None, found.asserted, found.inferred, found.strata)
        return Inferred(found.inferred, found.added, found.removed, found.seconds.total, found.mode)

    def _nothing(self, transaction: EmbeddedTransaction) -> Inferred:
        """Take out what was inferred."""
        graph = NamedNode(Iris(self._settings.base).graph("inferred"))
        removed = transaction.count(graph) if graph in transaction.graphs() else 0
        if removed:
            transaction.drop_graph(graph)
        return Inferred(0, 0, removed, 0.0, "none")

    def remember(self, generation: int | None) -> None:
        """Keep what the run read and inferred, as of the generation that its transaction made."""
        if self._runner is not None:
            self._runner.remember(generation)
        if self._last is not None:
            current = generation or self._store.layout.current()
            note_run(self._store.layout.cache, replace(self._last, generation=current))
