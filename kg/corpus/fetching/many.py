"""Fetching of a corpus: several repositories in parallel, each complete or not at all, pinned in a lock file.

    fetch(read_wanted(Path("robots.txt")), Path("robots"), Path("robots/corpus.lock.toml"), options)

The lock file is written after each repository, so an interruption loses nothing that is finished. Unfinished work is in
the folder `.fetching`, which the next run empties.
"""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Event
from typing import Final, Protocol

from kg.corpus.fetching.git import StoppedError
from kg.corpus.fetching.lock import FETCHED, Entry, Lock, read_lock, write_lock
from kg.corpus.fetching.one import Options, fetch_one
from kg.corpus.fetching.wanted import Wanted, wanted_among
from kg.errors import Place, SourceError

_WORKSPACE: Final = ".fetching"
_TICK_SECONDS: Final = 0.2


@dataclass(frozen=True, slots=True)
class Fetched:
    """The result: the lock file, and the requested entries in the order of completion."""

    lock: Lock
    entries: tuple[Entry, ...]

    @property
    def failed(self) -> tuple[Entry, ...]:
        """Entries whose files are not present as requested."""
        return tuple(entry for entry in self.entries if entry.state != FETCHED)


class Progress(Protocol):
    """Receives progress, in the thread that called `fetch`."""

    def begin(self, repositories: int) -> None:
        """The number of repositories."""

    def ended(self, entry: Entry) -> None:
        """One repository is finished."""


def pinned(lock: Path) -> tuple[Wanted, ...]:
    """Return the repositories in a lock file. Raises SourceError (KG101, KG132) if it is unreadable."""
    return tuple(wanted_of(entry) for entry in read_lock(lock).entries)


def wanted_of(entry: Entry) -> Wanted:
    """Return the request of an entry. Lock files may come from others, so they are validated like lists."""
    parsed = wanted_among([entry.url])[0]
    if parsed.name == entry.name:
        return parsed
    return Wanted(entry.name, entry.url, None, parsed.problem or f"the name of {entry.url} is {parsed.name}")


def fetch(wanted: Sequence[Wanted], folder: Path, lock: Path, options: Options, progress: Progress) -> Fetched:
    """Fetch repositories into `folder`, those in the lock file at their commits, and write the lock file.

    A failure does not stop the others. Other entries of the lock file are unchanged.

    Raises:
        SourceError: KG132 an invalid lock file, KG138 another process fetches into the folder.
        KeyboardInterrupt: after git was stopped and the lock file written.
    """
    entries = {entry.name: entry for entry in read_lock(lock).entries} if lock.exists() else {}
    progress.begin(len(wanted))
    done: list[Entry] = []
    with _workspace(folder) as workspace:
        for entry in _all(wanted, entries, folder, workspace, options):
            placed = replace(entry, folder=os.path.relpath(folder / entry.name, lock.absolute().parent))
            entries[entry.name] = placed if entry.state != "refused" else replace(entry, folder="")
            write_lock(lock, entries.values())
            done.append(entries[entry.name])
            progress.ended(entries[entry.name])
    return Fetched(write_lock(lock, entries.values()), tuple(done))


def _all(
    wanted: Sequence[Wanted], entries: dict[str, Entry], folder: Path, workspace: Path, options: Options
) -> Iterator[Entry]:
    """Yield the entries as they finish; if the caller stops early, all work is stopped first."""
    stop = Event()
    with ThreadPoolExecutor(options.jobs, thread_name_prefix="fetch") as pool:

        def work(number: int, one: Wanted, pin: Entry | None) -> Entry:
            own = workspace / str(number)
            if stop.is_set():
                raise StoppedError
            own.mkdir()
            try:
                return fetch_one(one, pin, folder / one.name, own, options, stop)
            except OSError as error:
                entry = pin or Entry(one.name, one.url)
                return replace(entry, state="failed", reason=f"{error.strerror}: {error.filename or own}")
            finally:
                shutil.rmtree(own, ignore_errors=True)

        pending: set[Future[Entry]] = set()
        for number, one in enumerate(wanted):
            pin = None if options.update else entries.get(one.name)
            if pin and one.ref and one.ref not in {pin.branch, pin.commit}:
                pin = None  # a newly requested ref overrides the pin of another
            pending.add(pool.submit(work, number, one, pin))
        try:
            while pending:
                finished, pending = wait(pending, _TICK_SECONDS, FIRST_COMPLETED)
                yield from (one.result() for one in finished)
        finally:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _workspace(folder: Path) -> Iterator[Path]:
    """Yield an empty folder for unfinished work, locked against other processes."""
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
