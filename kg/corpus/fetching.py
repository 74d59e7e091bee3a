"""Fetching the repositories of a corpus: several at a time, each whole or not at all, pinned in a lock file.

    fetch(read_wanted(Path("robots.txt")), Path("robots"), Path("robots/corpus.lock.toml"), options)

The lock file is written whenever a repository is done, so that what is done stays done however the work ends. What is
under way stands in `.fetching` in the folder, which the next run empties.
"""

from __future__ import annotations

import fcntl
import os
import shutil
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from threading import Event
from typing import TYPE_CHECKING, Final, Protocol

from kg.corpus.fetching_git import Limits, StoppedError
from kg.corpus.fetching_list import Wanted, wanted_among
from kg.corpus.fetching_lock import FETCHED, Entry, Lock, read_lock, write_lock
from kg.corpus.fetching_one import Choice, fetch_one
from kg.errors import Place, SourceError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

_WORKSPACE: Final = ".fetching"
_TICK_SECONDS: Final = 0.2


@dataclass(frozen=True, slots=True)
class Options:
    """How a corpus is fetched: `jobs` at a time; with `update` pinned commits are given up for those of today."""

    ros: str = "any"
    jobs: int = 4
    submodules: bool = False
    update: bool = False
    limits: Limits = field(default_factory=Limits)


@dataclass(frozen=True, slots=True)
class Fetched:
    """What became of it: the lock file, and the entries that were asked for, in the order that they were done."""

    lock: Lock
    entries: tuple[Entry, ...]

    @property
    def failed(self) -> tuple[Entry, ...]:
        """Those whose files are not there as asked for."""
        return tuple(entry for entry in self.entries if entry.state != FETCHED)


class Told(Protocol):
    """Who is told of the progress; from the thread that called `fetch`."""

    def begin(self, repositories: int) -> None:
        """So many are to be done."""

    def ended(self, entry: Entry) -> None:
        """One is done."""


def pinned(lock: Path) -> tuple[Wanted, ...]:
    """Return the repositories that a lock file names. Raises SourceError (KG101, KG132) when it cannot be read."""
    return tuple(_from_lock(entry) for entry in read_lock(lock).entries)


def _from_lock(entry: Entry) -> Wanted:
    """Return what an entry asks for. Lock files come from others too: what they name is checked as lists are."""
    found = wanted_among([entry.url])[0]
    if found.name == entry.name:
        return found
    return Wanted(entry.name, entry.url, None, found.problem or f"the name of {entry.url} is {found.name}")


def fetch(wanted: Sequence[Wanted], folder: Path, lock: Path, options: Options, told: Told) -> Fetched:
    """Fetch repositories into `folder`, those in the lock file at their commits, and write the lock file.

    None stops the others. Entries of the lock file that are not wanted stay as they are.

    Raises:
        SourceError: KG132 for a lock file that cannot be used, KG138 when another process fetches into the folder.
        KeyboardInterrupt: after git was ended and the lock file written.
    """
    entries = {entry.name: entry for entry in read_lock(lock).entries} if lock.exists() else {}
    told.begin(len(wanted))
    done: list[Entry] = []
    with _workspace(folder) as workspace:
        for entry in _all(wanted, entries, folder, workspace, options):
            placed = replace(entry, folder=os.path.relpath(folder / entry.name, lock.absolute().parent))
            entries[entry.name] = placed if entry.state != "refused" else replace(entry, folder="")
            write_lock(lock, entries.values())
            done.append(entries[entry.name])
            told.ended(entries[entry.name])
    return Fetched(write_lock(lock, entries.values()), tuple(done))


def _all(
    wanted: Sequence[Wanted], entries: dict[str, Entry], folder: Path, workspace: Path, options: Options
) -> Iterator[Entry]:
    """Yield the entries as they are done; when the caller gives up, all work is ended before this ends."""
    stop = Event()
    choice = Choice(options.ros, options.submodules, options.limits)
    with ThreadPoolExecutor(options.jobs, thread_name_prefix="fetch") as pool:

        def work(number: int, one: Wanted, pin: Entry | None) -> Entry:
            own = workspace / str(number)
            if stop.is_set():
                raise StoppedError
            own.mkdir()
            try:
                return fetch_one(one, pin, folder / one.name, own, choice, stop)
            except OSError as error:
                known = pin or Entry(one.name, one.url)
                return replace(known, state="failed", reason=f"{error.strerror}: {error.filename or own}")
            finally:
                shutil.rmtree(own, ignore_errors=True)

        pins = {one.name: _pin(one, entries, update=options.update) for one in wanted}
        pending: set[Future[Entry]] = {
            pool.submit(work, number, one, pins[one.name]) for number, one in enumerate(wanted)
        }
        try:
            while pending:
                finished, pending = wait(pending, _TICK_SECONDS, FIRST_COMPLETED)
                yield from (one.result() for one in finished)
        finally:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)


def _pin(one: Wanted, entries: dict[str, Entry], *, update: bool) -> Entry | None:
    """Return the entry that holds for a repository: a ref that is named now wins over what was pinned for another."""
    found = entries.get(one.name)
    return None if found is None or update or (one.ref and one.ref not in {found.branch, found.commit}) else found


@contextmanager
def _workspace(folder: Path) -> Iterator[Path]:
    """Provide the empty folder for what is under way, held against other processes."""
    workspace = folder / _WORKSPACE
    try:
        workspace.mkdir(parents=True, exist_ok=True)
        handle = os.open(workspace, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError as error:
        raise SourceError("KG101", f"{folder} cannot be written: {error.strerror}") from error
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise SourceError("KG138", "another process fetches into this folder", place=Place(str(folder))) from None
    try:
        for left in workspace.iterdir():
            shutil.rmtree(left, ignore_errors=True)
        yield workspace
    finally:
        shutil.rmtree(workspace, ignore_errors=True)
        os.close(handle)
