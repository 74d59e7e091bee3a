"""Watch rules: when one is saved, check it, test its examples, and compare its effect with the store."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Self

from kg.errors import KgError, RuleError, StoreError
from kg.graph.vocabulary import RNKG
from kg.pipeline.reasoning import check_context, explained_vocabulary
from kg.rules.authoring.differences import Difference, difference
from kg.rules.authoring.library import Entry, Library, Watched
from kg.rules.authoring.starting import choose
from kg.rules.authoring.testing import Result, parted, run_examples
from kg.rules.authoring.workbench import Workbench
from kg.rules.checks.finding import Context, Finding, from_error
from kg.rules.checks.run import Read, check
from kg.rules.explain.view import View
from kg.rules.files import RuleSet
from kg.rules.recording import Names
from kg.store.opening import existing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from kg.settings import Settings

_INTERVAL: Final = 0.2
"""Interval of the checks for changed files, in seconds."""


@dataclass(frozen=True, slots=True)
class Glance:
    """Status of some rules: findings, results of their examples, changes they would make in the store.

    `problem` explains a missing difference; `view` names things as in the store.
    """

    names: tuple[str, ...]
    gone: tuple[str, ...]
    findings: tuple[Finding, ...]
    results: tuple[Result, ...]
    difference: Difference | None
    problem: KgError | None
    view: View | None
    seconds: float


def glances(
    settings: Settings, named: Sequence[str] = (), wait: Callable[[float], object] = time.sleep
) -> Iterator[Glance]:
    """Yield the status of the rules named, or of all the user's, and then of each one that is saved, without end.

    `wait` is called between two checks. Raises UnknownNameError KG001 for an unknown rule.
    """
    with _RuleStatus(settings) as status:
        wanted = {entry.name for entry in choose(status.library, named)} if named else None
        first = [
            entry
            for entry in status.library.entries.values()
            if (entry.own if wanted is None else entry.name in wanted)
        ]
        watched = Watched(status.library)
        yield status.look(first, [])
        while True:
            wait(_INTERVAL)
            saved = watched.saved()
            entries = [entry for entry in saved.entries if wanted is None or entry.name in wanted]
            gone = [name for name in saved.gone if wanted is None or name in wanted]
            if entries or gone:
                yield status.look(entries, gone)


class _RuleStatus:
    """The current rules and the open store, both reused until they change."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self.library = Library.of(settings)
        self._bench: Workbench | None = None
        self._context: Context | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def _close(self) -> None:
        if self._bench is not None:
            self._bench.snapshot.close()
        self._bench = self._context = None

    def _open(self) -> Workbench | None:
        """Return the current store; None if there is none."""
        try:
            store = existing(self._settings)
            if self._bench is not None and self._bench.snapshot.generation == store.layout.current():
                return self._bench
            self._close()
            self._bench = Workbench(store.read(), Names.of(self._settings.base, RNKG))
        except StoreError:
            self._close()
        return self._bench

    def look(self, entries: Sequence[Entry], gone: Sequence[str]) -> Glance:
        """Return the status of some rules."""
        begin = time.perf_counter()
        bench = self._open()
        names = [entry.name for entry in entries]
        findings = self._findings(names)
        broken = {finding.rule for finding in findings if finding.severity == "error"}
        sound = [entry for entry in entries if entry.name not in broken]
        results = tuple(run_examples(parted(sound)[0], self.library))
        changed, problem = None, None
        if bench is not None and (sound or gone):
            changed, problem = self._difference(bench, sound)
        view = View(bench.snapshot, explained_vocabulary(self._settings)) if bench else None
        seconds = time.perf_counter() - begin
        return Glance(tuple(names), tuple(gone), tuple(findings), results, changed, problem, view, seconds)

    def _difference(self, bench: Workbench, entries: Sequence[Entry]) -> tuple[Difference | None, KgError | None]:
        try:
            files = self.library.with_those_in_force(entries)
            names = {entry.name for entry in entries}
            return difference(bench, files, [file for file in files if file.name in names]), None
        except RuleError as error:
            return None, error

    def _findings(self, names: Sequence[str]) -> list[Finding]:
        if self._context is None:
            self._context = check_context(self._settings, self._bench.snapshot if self._bench else None)
        unread, files = [], []
        for entry in self.library.entries.values():
            if entry.in_force or entry.name in names:
                try:
                    files.append(self.library.read(entry.name))
                except RuleError as error:
                    if entry.name in names:
                        unread.append(from_error(error, entry.name, error.place or entry.place))
        return check(Read(RuleSet(tuple(files)), tuple(unread)), self._context, names)
