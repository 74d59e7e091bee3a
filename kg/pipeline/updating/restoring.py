"""Restore a backup, and clear the caches of the replaced data."""

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
    """Result of a restore: the identity of the data, the number of quads, and the snapshot in the backup."""

    snapshot: int
    quads: int
    original: int | None


def restore(store: EmbeddedStore, source: Path) -> Restored:
    """Replace the whole content of a store by a backup, a folder or a file, as a new snapshot.

    The next build reads every source again. Raises as `kg.store.backups.restore`, and StoreError KG302 while another
    process writes.
    """
    with store.write("kg restore") as transaction:
        manifest = backups.restore(transaction, source)
        state.discard(store.layout.cache)
    with store.read() as snapshot:
        return Restored(snapshot.generation, snapshot.count(), manifest.snapshot if manifest else None)
