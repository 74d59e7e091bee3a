"""Which files of rules, or of their examples, were saved since one last looked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.rules.reading import changed_at

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.authoring.library import Entry, Library


@dataclass(frozen=True, slots=True)
class Saved:
    """The rules that were saved or came, and the names of those that went."""

    entries: list[Entry]
    gone: list[str]

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
        if not self._folders or any(changed_at(folder) != time for folder, time in self._folders.items()):
            # A file came or went: only then the folders are searched.
            self._folders = {folder: changed_at(folder) for folder in self._library.directories()}
            self._library.refresh()
        entries, before = self._library.entries, self._times
        self._times = {name: (changed_at(one.path), changed_at(one.examples)) for name, one in entries.items()}
        changed = [entries[name] for name, times in self._times.items() if before.get(name) != times]
        return Saved(changed, sorted(before.keys() - self._times.keys()))
