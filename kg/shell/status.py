"""The line at the foot: store, snapshot, what runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.widgets import Static

from kg.render.text import count, printable

if TYPE_CHECKING:
    from pathlib import Path

    from kg.query.readers.pool import Job


class Status(Static):
    """Says what is worked on."""

    def __init__(self, store: Path) -> None:
        super().__init__(markup=False)
        self._store = _short(store)
        self._snapshot: int | None = None
        self._work = ""
        self._note = ""

    def tell(self, snapshot: int | None, note: str = "") -> None:
        """Say which generation of the store is in force, None when it is not there, and what became of it."""
        self._snapshot, self._note = snapshot, note
        self._draw()

    def run(self, job: Job | None, rows: int = 0) -> None:
        """Say what runs; None when nothing does."""
        if job is None:
            self._work = ""
        else:
            found = f", {count(rows, 'row')} so far" if rows else ""
            self._work = f"running {job.elapsed:.1f} s{found} (Esc stops)"
        self._draw()

    def _draw(self) -> None:
        state = "store is gone" if self._snapshot is None else f"snapshot {self._snapshot}"
        parts = [self._work, self._note, state, self._store]
        self.update(printable("  ·  ".join(part for part in parts if part)))


def _short(path: Path) -> str:
    """Return the path of a store, below the home folder with a tilde."""
    home = path.home()
    folder = path.parent if path.name == ".kg" else path
    return f"~/{folder.relative_to(home)}" if folder.is_relative_to(home) else str(folder)
