"""Lines of a store's sources, as far as their files are on this machine."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.graph.source_states import sources

if TYPE_CHECKING:
    from kg.store.interface import Snapshot

_LARGEST: Final = 4_000_000
"""Maximum size in bytes of a source file, as by default in builds."""


class SourceLines:
    """The files of the sources of a store."""

    def __init__(self, snapshot: Snapshot) -> None:
        self.states = {one.name: one for one in sources(snapshot)}
        self.lines = lru_cache(maxsize=256)(self._lines)
        """Returns the lines of a file of a source; None if it is missing or not text."""

    def root(self, repository: str) -> Path | None:
        """Return the folder of a source on this machine; None without one."""
        state = self.states.get(repository)
        root = Path(state.root) if state and state.root else None
        return root if root and root.is_dir() else None

    def _lines(self, repository: str, path: str) -> list[str] | None:
        root = self.root(repository)
        if root is None:
            return None
        file = root / path
        try:
            # A path in a store from elsewhere must not lead out of its source.
            if not file.resolve().is_relative_to(root.resolve()) or file.stat().st_size > _LARGEST:
                return None
            return file.read_bytes().decode("utf-8", "replace").split("\n")
        except OSError:
            return None

    def text(self, repository: str, path: str, line: int) -> str | None:
        """Return one line without surrounding whitespace; None if it does not exist."""
        lines = self.lines(repository, path)
        return lines[line - 1].strip() if lines and 0 < line <= len(lines) else None

    def address(self, repository: str, path: str, line: int) -> str:
        """Return the address of a line: the page of its commit, else the file."""
        state = self.states.get(repository)
        if state is None:
            return f"{path}:{line}"
        return state.page(path, line) or f"{Path(state.root or '') / path}:{line}"
