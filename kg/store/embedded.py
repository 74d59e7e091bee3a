"""The local store: generations of a RocksDB database, and a pointer to the current one.

    store = EmbeddedStore.find(Path.cwd())
    with store.read() as snapshot: ...
    with store.write("kg build src") as transaction: ...

Readers never wait and never see partial changes: they hold the generation that was current when they began. A
writer creates a new generation. If it is killed, it leaves a folder without a pointer to it, which the next
writer deletes.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from kg.lazily import lazily
from kg.store import layout as layouts
from kg.store.failure import remote_refusal
from kg.store.locks import remove_unused, writer
from kg.store.snapshot import EmbeddedSnapshot
from kg.store.transaction import EmbeddedTransaction

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.store.layout import Layout

with lazily():
    from kg.store.remote_reading import RemoteReading


class EmbeddedStore:
    """A store in a local folder."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout

    @classmethod
    def find(cls, start: Path) -> EmbeddedStore:
        """Return the store of `start` or of the nearest folder above it; StoreError KG301 if there is none."""
        return cls(layouts.find(start))

    @classmethod
    def create(cls, root: Path) -> EmbeddedStore:
        """Return the store whose folder (`.kg`) is `root`, created if missing."""
        return cls(layouts.create(root))

    def read(self) -> EmbeddedSnapshot:
        """Return the content in force; a context manager, closed at the end of its `with` statement.

        Raises:
            StoreError: KG301 without data, KG303 damaged, KG305 of another layout, KG225 for an address of a server
                that cannot be used.
        """
        if self.layout.address is not None:
            return RemoteReading(self.layout)
        return EmbeddedSnapshot(self.layout)

    @contextmanager
    def write(self, command: str) -> Iterator[EmbeddedTransaction]:
        """Begin a transaction; `command` is the running command in errors of other writers.

        Raises:
            StoreError: KG302 while another process writes, KG304 when the disk fills up, KG306 when the folder
                cannot be written, KG309 for one on a server, KG303 and KG305 as `read`.
        """
        if self.layout.address is not None:
            raise remote_refusal(self.layout.address)
        with writer(self.layout, command):
            remove_unused(self.layout)
            transaction = EmbeddedTransaction(self.layout)
            try:
                yield transaction
                transaction.commit()
            except BaseException:
                transaction.roll_back()
                raise
            remove_unused(self.layout)
