"""Restore a backup, and drop the caches of the data that it replaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.pipeline import state
from kg.store import backups

if TYPE_CHECKING:
    from pathlib import Path

    from kg.store.embedded import EmbeddedStore


@dataclass(frozen=True, slots=True)
class Restored:
    """Result of a restore: the identity of the data, the number of quads, and the snapshot that was backed up."""

    snapshot: int
    quads: int
    original: int | None


def restore(store: EmbeddedStore, source: Path) -> Restored:
    """Put a backup, a folder or a file, in the place of all that a store holds, as a new snapshot.

    The next build reads every source again. Raises as `kg.store.backups.restore`, and StoreError KG302 while another
    process writes.
    """
    with store.write("kg restore") as transaction:
        found = backups.restore(transaction, source)
        state.discard(store.layout.cache)
    with store.read() as snapshot:
        return Restored(snapshot.generation, snapshot.count(), found.snapshot if found else None)
