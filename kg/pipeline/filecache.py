"""Values computed from files of an installation, cached between processes until one of these files changes."""

from __future__ import annotations

import hashlib
import os
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, TypeVar

from kg.store.failure import translated
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator
    from functools import _lru_cache_wrapper

_Value = TypeVar("_Value")
_SETTLED: Final = 2_000_000_000
"""Nanoseconds after which another change of a file certainly gives it another time."""
_BYTES: Final = 16


class State(NamedTuple):
    """A file by its metadata; times in nanoseconds. Every change of a file sets the time `changed`."""

    path: str
    number: int
    size: int
    modified: int
    changed: int


def states(root: Path | str) -> Iterator[State]:
    """Yield the state of each file in a folder, or of a file; unreadable ones are skipped."""
    try:
        entries = sorted(os.scandir(root), key=lambda entry: entry.name)
    except NotADirectoryError:
        yield _state(str(root), Path(root).stat())
        return
    except OSError:
        return
    for entry in entries:
        if not entry.is_dir(follow_symlinks=False):
            with suppress(OSError):
                yield _state(entry.path, entry.stat())
        elif entry.name != "__pycache__":
            yield from states(entry.path)


def installations() -> Iterator[State]:
    """Yield the states of the folders of installed packages, which change when a package is installed or removed."""
    for place in sys.path:
        with suppress(OSError):
            yield _state(place, Path(place).stat())


def are_stable(seen: tuple[State, ...]) -> bool:
    """Return whether the files are old enough that any further change gives them another state."""
    return time.time_ns() - max((state.changed for state in seen), default=0) > _SETTLED


def unless_changed(make: _lru_cache_wrapper[_Value], *arguments: Hashable, seen: tuple[State, ...]) -> _Value:
    """Return `make(*arguments, seen)`: what this process has cached for the states `seen`, if these are stable."""
    compute = make if are_stable(seen) else make.__wrapped__
    return compute(*arguments, seen)


def cached_text(place: Path | None, seen: tuple[State, ...], what: object, make: Callable[[], str]) -> str:
    """Return the text that `make` returns, cached in the file `place` for the same `what` and states `seen`.

    Without a place it is computed each time. StoreError KG304, KG306 if the file cannot be written.
    """
    if place is None or not are_stable(seen):
        return make()
    key = hashlib.blake2b(repr((seen, what)).encode(), digest_size=_BYTES).hexdigest()
    with suppress(OSError, ValueError):
        before, _, text = place.read_text("utf-8").partition(" ")
        if before == key:
            return text
    text = make()
    with translated(str(place)):
        place.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(place, f"{key} {text}".encode(), durable=False)
    return text


def _state(path: str, status: os.stat_result) -> State:
    return State(path, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
