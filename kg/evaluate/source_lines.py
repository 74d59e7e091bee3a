"""Lines of a store's sources, as far as their files are on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.lint.lines import Lines

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.graph.source_states import SourceState


class SourceLines:
    """The files of the sources of a store."""

    def __init__(self, sources: Iterable[SourceState]) -> None:
        self.states = {one.name: one for one in sources}
        self._lines = Lines({name: one.root for name, one in self.states.items() if one.root})

    def root(self, repository: str) -> Path | None:
        """Return the folder of a source on this machine; None without one."""
        state = self.states.get(repository)
        root = Path(state.root) if state and state.root else None
        return root if root and root.is_dir() else None

    def lines(self, repository: str, path: str) -> Sequence[str]:
        """Return the lines of a file of a source; none if it is missing."""
        return self._lines.of(repository, path)

    def text(self, repository: str, path: str, line: int) -> str | None:
        """Return one line without surrounding whitespace; None if it does not exist."""
        lines = self.lines(repository, path)
        return lines[line - 1].strip() if 0 < line <= len(lines) else None

    def address(self, repository: str, path: str, line: int) -> str:
        """Return the address of a line: the page of its commit, else the file."""
        state = self.states.get(repository)
        if state is None:
            return f"{path}:{line}"
        return state.page(path, line) or f"{Path(state.root or '') / path}:{line}"
