"""Locks of a store: one writer at a time, and readers that keep their generation from being removed.

All are `flock` locks: they belong to an open file, so the end of a process, however it comes, frees them.
"""

from __future__ import annotations

import fcntl
import json
import os
import shutil
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from kg.errors import Place, StoreError
from kg.store.failure import translated

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.store.layout import Layout

__all__ = ["busy", "hold_generation", "remove_unused", "writer"]


@contextmanager
def writer(layout: Layout, command: str) -> Iterator[None]:
    """Hold the one right to write the store while the body runs; `command` is what others are told is running.

    Raises:
        StoreError: KG302 naming process, command and start of the one that writes.
    """
    with translated(str(layout.root)):
        file = layout.lock.open("a+")
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise _busy(layout) from error
        file.truncate(0)
        since = datetime.now(UTC).astimezone().isoformat(timespec="seconds")
        file.write(json.dumps({"pid": os.getpid(), "command": command, "since": since}))
        file.flush()
        try:
            yield
        finally:
            file.truncate(0)


def busy(layout: Layout) -> StoreError | None:
    """Return the error that a writer would meet now because another one is at work, None when the way is free."""
    try:
        with layout.lock.open() as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return None
    except BlockingIOError:
        return _busy(layout)
    return None


def _busy(layout: Layout) -> StoreError:
    try:
        holder = json.loads(layout.lock.read_text())
        message = f"process {holder['pid']} (`{holder['command']}`) has been writing it since {holder['since']}"
        hint = f"Wait for it, or end it with `kill {holder['pid']}`."
    except (OSError, ValueError, KeyError, TypeError):
        message, hint = "another process is just beginning or ending to write it", "Try again."
    return StoreError("KG302", message, place=Place(str(layout.root)), hint=hint)


def hold_generation(layout: Layout) -> tuple[int, int]:
    """Return the generation in force and an open file whose closing lets go of it.

    Raises:
        StoreError: KG301 when nothing was ever written, KG303 when the generation in force is gone.
    """
    while True:
        number = layout.current()
        if number is None:
            hint = "Run `kg build FOLDER` or `kg demo` first."
            raise StoreError(
                "KG301", "nothing has been built in this store yet", place=Place(str(layout.root)), hint=hint
            )
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
    # The writer may have removed the folder between the opening and the lock.
    if folder.exists() and os.fstat(handle).st_ino == folder.stat().st_ino:
        return handle
    os.close(handle)
    return None


def remove_unused(layout: Layout) -> None:
    """Remove every generation that is neither in force nor held by a reader; only the writer may call this.

    What a killed writer left of its temporary files goes too.
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
