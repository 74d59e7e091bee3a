"""What was run before."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from kg.render.text import count
from kg.shell.screens.listing import ListScreen

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.shell.state import Entry


class HistoryScreen(ListScreen):
    """Searches the history; its answer is the text of a query."""

    TITLE_WORDS = "History"
    EMPTY = "Nothing was run yet."

    def __init__(self, entries: Sequence[Entry]) -> None:
        super().__init__()
        self.entries = list(entries)

    def words(self, entry: Entry) -> tuple[str, str]:
        """Return the query on one line, and what came of it."""
        came = count(entry.rows, "row") if entry.outcome == "ok" else entry.outcome
        return " ".join(entry.text.split()), came

    def preview(self, entry: Entry) -> str:
        """Return the whole query, with when and where it ran."""
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(entry.when))
        return f"{entry.text}\n\n{when} · {entry.seconds:.2f} s · {entry.store}"

    def choose(self, entry: Entry) -> None:
        """Answer with the query."""
        self.dismiss(entry.text)
