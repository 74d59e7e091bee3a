"""Progress of `kg corpus fetch`: a bar on a terminal, else a line per repository; and a summary."""

from __future__ import annotations

import sys
from collections import Counter
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from kg.cli.diagnostics import note, problem, say
from kg.cli.progress import ProgressBar
from kg.corpus.fetching.lock import FETCHED, Entry, Lock, Standing
from kg.render.text import count, printable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.fetching.many import Fetched

_CODES: Final = {"refused": "KG134", "too large": "KG135", "too slow": "KG135", "in the way": "KG137"}
_LONGEST_NAME: Final = 40


def code_of(entry: Entry) -> str | None:
    """Return the code of the error that prevented fetching a repository; None on success."""
    return None if entry.state == FETCHED else _CODES.get(entry.state, "KG133")


class Lines:
    """One line for each repository."""

    def __init__(self) -> None:
        self._all = 0
        self._done = 0

    def begin(self, repositories: int) -> None:
        """Write the number of repositories."""
        self._all = repositories
        say(f"fetching {count(repositories, 'repository', 'repositories')}")

    def ended(self, entry: Entry) -> None:
        """Write the result of one repository."""
        self._done += 1
        where = f" {entry.branch} {entry.commit[:12]}".rstrip() if entry.state == FETCHED else ""
        say(f"{self._done}/{self._all} {printable(entry.name)}: {entry.state}{printable(where)}")


class Bar(ProgressBar):
    """A progress bar of repositories, with the last finished one."""

    def __init__(self) -> None:
        super().__init__("fetching", _LONGEST_NAME, threaded=True)

    def ended(self, entry: Entry) -> None:
        """Advance the bar."""
        self.show(entry.name[-_LONGEST_NAME:], advance=1)


def for_this_stream() -> AbstractContextManager[Bar | Lines]:
    """Return the display that suits standard error."""
    return Bar() if sys.stderr.isatty() else nullcontext(Lines())


def summary(done: Fetched) -> None:
    """Report repositories that were not fetched with reasons, changed commits, and totals."""
    for entry in sorted(done.entries, key=lambda one: one.name):
        if failed(entry):
            continue
        if entry.moved:
            note(f"{printable(entry.name)} moved to {printable(entry.moved)}")
        elif entry.reason:
            note(f"{printable(entry.name)}: {printable(entry.reason)}")
    states = Counter(entry.state for entry in done.entries)
    size = sum(entry.bytes for entry in done.entries if entry.state == FETCHED)
    others = "".join(f", {number:,} {state}" for state, number in sorted(states.items()) if state != FETCHED)
    fetched = count(states[FETCHED], "repository", "repositories")
    say(f"{fetched} fetched ({size / 1e6:,.1f} MB){others}; {printable(str(done.lock.path))} pins them")


def failed(entry: Entry) -> bool:
    """Return whether a repository was not fetched, and report the reason."""
    code = code_of(entry)
    if code:
        problem(code, f"{entry.state}: {entry.reason}", entry.name)
    return code is not None


def left_out(entries: Sequence[Entry]) -> bool:
    """Report the repositories that workers of a cluster could not fetch; return whether there are any."""
    for entry in sorted(entries, key=lambda one: one.name):
        failed(entry)
    if entries:
        note(f"{count(len(entries), 'repository', 'repositories')} left out; build again to try again")
    return bool(entries)


def not_as_pinned(lock: Lock, state: Standing) -> None:
    """Report the repositories of a lock file that are missing or differ from it."""
    place = printable(str(lock.path))
    for entry in state.missing:
        why = "was not fetched" if entry.state == FETCHED else f"{entry.state}: {entry.reason}"
        problem("KG136", why, entry.name)
    for entry, difference in state.drifted:
        problem("KG137", difference, entry.name)
    if state.missing:
        missing = count(len(state.missing), "repository", "repositories")
        note(f"{missing} of {place} not checked out; fetch them with `kg corpus fetch --lock {place}`")
    if state.drifted:
        note(f"{count(len(state.drifted), 'checkout')} not at the commits that {place} pins; building them as they are")


def entry_object(entry: Entry) -> dict[str, Any]:
    """Return an entry as plain values for JSON, with its code."""
    return {**asdict(entry), "code": code_of(entry)}
