"""Cache of the statistics of snapshots, in the process and in files.

    .kg/cache/completion-1/12/statistics.json     of the snapshot 12
    .kg/cache/completion-1/12/<digest>.json       values of a property (`kg.query.completion.names`)

Errors when writing the files are ignored.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Final, TypeVar

import msgspec

from kg.query.completion.statistics import Statistics, count, declared
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from kg.store.interface import Snapshot

_FORMAT: Final = 1
"""Version of the format of the files."""
_Content = TypeVar("_Content")


class SnapshotCache:
    """Cache entries of one snapshot in `folder`, or only in memory if `folder` is None."""

    def __init__(self, folder: Path | None, snapshot: Snapshot) -> None:
        self._snapshot = snapshot
        self._folder = None if folder is None else folder / f"completion-{_FORMAT}"
        self._own = None if self._folder is None else self._folder / snapshot.identity
        self._statistics: Statistics | None = None
        self._memory: dict[str, object] = {}
        self._objects: dict[str, object] = {}

    def over(self, snapshot: Snapshot) -> SnapshotCache:
        """Return this cache with another snapshot object of the same content."""
        self._snapshot = snapshot
        return self

    @property
    def snapshot(self) -> Snapshot:
        """Snapshot of the entries."""
        return self._snapshot

    def statistics(self, *, fresh: bool = False) -> Statistics:
        """Return the statistics of the snapshot.

        Without `fresh`, statistics of an earlier snapshot are returned if those of this one are not cached, and empty
        ones while another process counts for the first time.
        """
        if self._statistics is not None:
            return self._statistics
        path = None if self._own is None else self._own / "statistics.json"
        statistics = _read(path, Statistics)
        if statistics is None and not fresh and (earlier := self._earlier()) is not None:
            return earlier
        if statistics is None:
            with _locked(self._folder, wait=fresh) as is_locked:
                statistics = _read(path, Statistics)
                if statistics is None and not is_locked:
                    return Statistics()
                if statistics is None:
                    statistics = count(self._snapshot, self.values)
                    _write(path, statistics)
                    self._forget()
        self._statistics = statistics
        return statistics

    def cached_statistics(self) -> Statistics:
        """Return the cached statistics, of this snapshot or of an earlier one."""
        if self._statistics is None:
            path = None if self._own is None else self._own / "statistics.json"
            self._statistics = _read(path, Statistics)
        return self._statistics or self._earlier() or Statistics()

    def prefixes(self) -> dict[str, str]:
        """Return the prefixes that the store declares, except the standard ones."""
        return self.in_memory("prefixes", lambda: declared(self._snapshot))

    def values(self, key: str, make: Callable[[], _Content], kind: type[_Content]) -> _Content:
        """Return the cached value of `key`, or the result of `make`."""
        if key not in self._memory:
            name = hashlib.sha256(key.encode()).hexdigest()[:32] + ".json"
            path = None if self._own is None else self._own / name
            content = _read(path, kind)
            if content is None:
                content = make()
                _write(path, content)
            self._memory[key] = content
        return self._memory[key]  # type: ignore[return-value] # each key has contents of one kind

    def in_memory(self, key: str, make: Callable[[], _Content]) -> _Content:
        """Return the value of `key` cached in memory, or the result of `make`; never written to a file."""
        if key not in self._objects:
            self._objects[key] = make()
        return self._objects[key]  # type: ignore[return-value] # each key has contents of one kind

    def _earlier(self) -> Statistics | None:
        """Return the newest statistics of another snapshot."""
        if self._folder is None or not self._folder.is_dir():
            return None
        numbers = sorted((int(each.name) for each in self._folder.iterdir() if each.name.isdigit()), reverse=True)
        earlier = (_read(self._folder / str(number) / "statistics.json", Statistics) for number in numbers)
        return next((each for each in earlier if each is not None), None)

    def _forget(self) -> None:
        """Delete the entries of other snapshots."""
        if self._folder is not None and self._folder.is_dir():
            for each in self._folder.iterdir():
                if each.is_dir() and each.name.isdigit() and each != self._own:
                    shutil.rmtree(each, ignore_errors=True)


def _read(path: Path | None, kind: type[_Content]) -> _Content | None:
    if path is None:
        return None
    try:
        return msgspec.json.decode(path.read_bytes(), type=kind)
    except (OSError, msgspec.DecodeError):
        return None


def _write(path: Path | None, content: object) -> None:
    if path is None:
        return
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, msgspec.json.encode(content), durable=False)


@contextmanager
def _locked(folder: Path | None, *, wait: bool) -> Iterator[bool]:
    """Lock the right to count, which the system releases on exit; False if another process has it."""
    try:
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
        handle = None if folder is None else os.open(folder / "lock", os.O_RDWR | os.O_CREAT)
    except OSError:
        handle = None
    if handle is None:
        yield True
        return
    try:
        fcntl.flock(handle, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        is_locked = True
    except BlockingIOError:
        is_locked = False
    try:
        yield is_locked
    finally:
        os.close(handle)
