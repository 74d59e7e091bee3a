"""Which files of rules, or of their examples, were saved since one last looked."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.authoring.library import Entry, Library


class Saved:
    """The rules that were saved or came, and the names of those that went."""

    def __init__(self, entries: list[Entry], gone: list[str]) -> None:
        self.entries = entries
        self.gone = gone

    def __bool__(self) -> bool:
        return bool(self.entries or self.gone)


class Watched:
    """The files of a library by their times; looking costs one call of the system a file and a folder."""

    def __init__(self, library: Library) -> None:
        self._library = library
        self._folders: dict[Path, int] = {}
        self._times: dict[str, tuple[int, int]] = {}
        self.saved()

    def saved(self) -> Saved:
        """Return the changes since the last call."""
        if not self._folders or any(_time(folder) != time for folder, time in self._folders.items()):
            # A file came or went: only then the folders are searched.
            self._folders = {folder: _time(folder) for folder in self._library.directories()}
            self._library.refresh()
        before, self._times = self._times, self._now()
        changed = [name for name, times in self._times.items() if before.get(name) != times]
        return Saved([self._library.entries[name] for name in changed], sorted(before.keys() - self._times.keys()))

    def _now(self) -> dict[str, tuple[int, int]]:
        return {name: (_time(entry.path), _time(entry.examples)) for name, entry in self._library.entries.items()}


def _time(path: Path) -> int:
    """Return when a file or folder was changed last, 0 when it is not there."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
