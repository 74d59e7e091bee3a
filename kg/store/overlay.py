"""A generation with triples added for one query: a copy that shares its large files, deleted afterwards.

The copy is made as for backups: with hard links on the file system of the store, in milliseconds for any size. Added
triples are written to the copy only.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pyoxigraph import NamedNode, Store

from kg.store import bulk
from kg.store.failure import translated
from kg.store.snapshot import EmbeddedSnapshot


class _Overlay(EmbeddedSnapshot):
    """A copy of a snapshot, with the same generation number."""

    def __init__(self, snapshot: EmbeddedSnapshot, folder: Path) -> None:
        self.generation, self._handle = snapshot.generation, -1
        snapshot.backup(str(folder))
        self._db = Store(str(folder))

    def add(self, graph: NamedNode, chunks: Iterable[bytes]) -> None:
        """Add chunks of N-Triples to a graph."""
        bulk.add(lambda: self._db, graph, b"".join(chunks))

    def close(self) -> None:
        """Close the copy, then delete its folder, as closing writes to it."""
        if hasattr(self, "_db"):
            del self._db


@contextmanager
def overlaid(
    snapshot: EmbeddedSnapshot, graph: NamedNode, chunks: Iterable[bytes], cache: Path
) -> Iterator[EmbeddedSnapshot]:
    """Yield a snapshot with N-Triples added to a graph; its files are in `cache`, or in the system's temporary folder.

    Raises:
        StoreError: KG304 full disk, KG306 if no folder is writable.
    """
    folder = _temporary(cache)
    try:
        with translated(str(folder)):
            overlay = _Overlay(snapshot, folder / "copy")
        with overlay:
            with translated(str(folder)):
                overlay.add(graph, chunks)
            yield overlay
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _temporary(cache: Path) -> Path:
    """Return a new folder: next to the store, where files can be shared, unless that is not writable."""
    try:
        cache.mkdir(parents=True, exist_ok=True)
        return Path(tempfile.mkdtemp(prefix="overlay-", dir=cache))
    except OSError:
        with translated(tempfile.gettempdir()):
            return Path(tempfile.mkdtemp(prefix="kg-overlay-"))
