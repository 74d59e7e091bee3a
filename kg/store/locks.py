"""Locks of a store: one writer at a time, and readers that protect their generation from deletion.

All are `flock` locks. They belong to an open file, so the system releases them when the process exits.
"""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import time
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Final

from kg.errors import Place, StoreError
from kg.store.failure import translated

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.store.layout import Layout

_PATIENCE: Final = 2.0
_PAUSE: Final = 0.01
"""Seconds: total wait for a lock without a live owner on record, and the interval of the attempts."""


@contextmanager
def writer(layout: Layout, command: str) -> Iterator[None]:
    """Hold the write lock of the store while the body runs; `command` is the running command in errors of others.

    Raises:
        StoreError: KG302 with process, command and start time of the current writer.
    """
    with translated(str(layout.root)):
        file = layout.lock.open("a+")
    with file:
        _acquire(file.fileno(), layout)
        file.truncate(0)
        since = datetime.now(UTC).astimezone().isoformat(timespec="seconds")
        file.write(json.dumps({"pid": os.getpid(), "command": command, "since": since}))
        file.flush()
        try:
            yield
        finally:
            file.truncate(0)
            # Closing the file is not enough: a forked process may still have a copy open.
            fcntl.flock(file, fcntl.LOCK_UN)


def _acquire(handle: int, layout: Layout) -> None:
    """Acquire the lock of the writer.

    The file names its owner. A lock without a named owner is released soon: another process only tests it, or a worker
    of a killed writer still has a copy open.
    """
    end = time.monotonic() + _PATIENCE
    while True:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            if _is_alive(_holder(layout)) or time.monotonic() > end:
                raise _busy(layout) from error
        else:
            return
        time.sleep(_PAUSE)


def busy(layout: Layout) -> StoreError | None:
    """Return the error that a writer would get now because another one is active, else None."""
    try:
        with layout.lock.open() as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return None
    except BlockingIOError:
        return _busy(layout)
    return None


def _holder(layout: Layout) -> dict[str, Any] | None:
    """Return the writer's record in the lock file, or None."""
    try:
        record = json.loads(layout.lock.read_text())
    except (OSError, ValueError):
        return None
    return record if isinstance(record, dict) and {"pid", "command", "since"} <= record.keys() else None


def _is_alive(holder: dict[str, Any] | None) -> bool:
    """Return whether the process on record exists."""
    if holder is None or not isinstance(holder["pid"], int):
        return False
    try:
        os.kill(holder["pid"], 0)
    except PermissionError:
        return True
    except (ProcessLookupError, OverflowError):
        return False
    return True


def _busy(layout: Layout) -> StoreError:
    if (holder := _holder(layout)) is not None:
        message = f"process {holder['pid']} (`{holder['command']}`) has been writing the store since {holder['since']}"
        hint = f"Wait for it, or end it with `kill {holder['pid']}`."
    else:
        message, hint = "another process is just beginning or ending to write the store", "Try again."
    return StoreError("KG302", message, place=Place(str(layout.root)), hint=hint)


def hold_generation(layout: Layout) -> tuple[int, int]:
    """Return the current generation, and an open file that protects it until closed.

    Raises:
        StoreError: KG301 if nothing was ever written, KG303 if the current generation is missing.
    """
    while True:
        number = layout.current()
        if number is None:
            message, hint = "nothing has been built in this store yet", "Run `kg build FOLDER` or `kg demo` first."
            holder = _holder(layout)
            if holder is not None and busy(layout):
                hint = f"Wait for process {holder['pid']} (`{holder['command']}`), which is building it."
            raise StoreError("KG301", message, place=Place(str(layout.root)), hint=hint)
        folder = layout.generation(number)
        handle = _hold(folder)
        if handle is not None:
            return number, handle
        if layout.current() == number:
            message = f"the data in force (generation {number}) is not there"
            raise StoreError("KG303", message, place=Place(str(folder)), hint="Build the store again with `kg build`.")


def _hold(folder: Path) -> int | None:
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except FileNotFoundError:
        return None
    fcntl.flock(handle, fcntl.LOCK_SH)
    # The writer may have deleted the folder between opening and locking it.
    if folder.exists() and os.fstat(handle).st_ino == folder.stat().st_ino:
        return handle
    os.close(handle)
    return None


def remove_unused(layout: Layout) -> None:
    """Delete every generation that is not current and not held by a reader; only for the writer.

    Temporary files of a killed writer are deleted too.
    """
    for left in layout.root.glob("*.tmp"):
        left.unlink(missing_ok=True)
    current = layout.current()
    for number in layout.numbers():
        if number != current:
            _remove(layout.generation(number))


def _remove(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return
    else:
        shutil.rmtree(folder, ignore_errors=True)
    finally:
        os.close(handle)
