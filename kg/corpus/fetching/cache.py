"""Checkouts of pinned commits in a cache folder of this machine, for workers of a cluster.

    entry, folder = checkout(pin, "robot", Path("~/.cache/kg/corpus").expanduser())

A checkout is for one address and commit, so its content never changes. It is complete or missing. Processes that need
the same one wait for the first. The cache can be deleted while no build runs.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
import tempfile
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Final

from kg.corpus.fetching.git import Limits
from kg.corpus.fetching.lock import FETCHED, Entry
from kg.corpus.fetching.many import wanted_of
from kg.corpus.fetching.one import Options, fetch_one
from kg.corpus.scanning import scan
from kg.errors import SourceError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import FileEntry, Pin, Source

LIMITS: Final = Limits()
_BYTES: Final = 16
_UNFINISHED: Final = ".fetching-"
_TIME_DIGITS: Final = 15
"""Number of hexadecimal digits of a commit from which the time of its files is computed."""


def checkout(pin: Pin, name: str, cache: Path) -> tuple[Entry, Path]:
    """Fetch a commit into a folder `name` of the cache, unless it is there; return its entry and that folder.

    If it failed, the state of the entry says why, and nothing of it is in the cache.
    """
    entry = Entry(pin.name, pin.url, commit=pin.commit)
    wanted = wanted_of(entry)
    problem = wanted.problem or ("" if name.strip(".") else f"{name!r} is not a valid folder name")
    if problem:  # names must not lead out of the cache
        return replace(entry, state="refused", reason=problem), cache
    around = cache / pin.name / hashlib.blake2b(f"{pin.url} {pin.commit}".encode(), digest_size=_BYTES).hexdigest()
    try:
        with _locked(around):
            for left in around.glob(f"{_UNFINISHED}*"):
                shutil.rmtree(left, ignore_errors=True)
            workspace = Path(tempfile.mkdtemp(prefix=_UNFINISHED, dir=around))
            try:
                return fetch_one(
                    wanted, entry, around / name, workspace, Options(limits=LIMITS), Event()
                ), around / name
            finally:
                shutil.rmtree(workspace, ignore_errors=True)
    except OSError as error:
        return replace(entry, state="failed", reason=f"{error.strerror}: {error.filename or around}"), around


def fetch_source(pin: Pin, root: Path, cache: Path) -> tuple[Entry, Source | None]:
    """Fetch a commit and scan it as the source in the folder `root`, which need not exist on this machine.

    Its times are computed from the commit, so they are equal on all machines.
    """
    entry, folder = checkout(pin, root.name, cache)
    if entry.state != FETCHED:
        return entry, None
    try:
        scanned = scan(folder)
    except SourceError as error:
        return replace(entry, state="failed", reason=error.message), None
    time = int(pin.commit[:_TIME_DIGITS], 16)
    packages = tuple(replace(one, files=_at(one.files, time)) for one in scanned.packages)
    repository = replace(scanned.repository, root=str(root))
    source = replace(
        scanned, repository=repository, root=root, packages=packages, loose=_at(scanned.loose, time), pin=pin
    )
    return entry, source


def _at(files: Iterable[FileEntry], time: int) -> tuple[FileEntry, ...]:
    return tuple(replace(one, mtime_ns=time) for one in files)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, which is created; wait for other processes of this machine."""
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder / ".lock", os.O_RDWR | os.O_CREAT, 0o600)  # a folder cannot be locked over NFS
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)
