"""The rules at hand, read one by one as they are needed: a file that does not parse hides no other.

`Watched` tells which of them, or of their examples, were saved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg import resources
from kg.errors import Place, RuleError
from kg.rules.files import RuleFile, family_of
from kg.rules.reading import Pack, changed_at, families_in_force, packs, read, rival, rule_files, sources, user_folders

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable
    from pathlib import Path

    from kg.settings import Settings


@dataclass(frozen=True, slots=True)
class Entry:
    """A file of rules that was not read yet; `pack` names the rule pack that brings it, empty for folders.

    `in_force` is False for rules of a family that is optional, or that the setting `rule_families` leaves out; `own`
    is True for rules that `kg` does not ship.
    """

    name: str
    path: Path
    pack: str = ""
    in_force: bool = True
    own: bool = True

    @property
    def family(self) -> str:
        """The first part of the name; empty for a file that is in no folder of its own."""
        return family_of(self.name)

    @property
    def examples(self) -> Path:
        """Path of its examples, whether it exists or not."""
        return self.path.with_suffix(".md")

    @property
    def place(self) -> Place:
        """The beginning of the file."""
        return Place(str(self.path), 1, 1)


class Library:
    """The rules of some folders and packs by name, sorted. A file is read again when it has changed.

    `problems` are the files whose name another has (KG207), but for copies of it.
    """

    def __init__(self, folders: Iterable[Path], installed: Iterable[Pack] = (), families: Collection[str] = ()) -> None:
        """Raise `RuleError` KG231 for a folder that is not there or is closed."""
        self._sources = sources(folders, installed)
        self._families = families
        self._read: dict[str, tuple[int, RuleFile]] = {}
        self.entries: dict[str, Entry] = {}
        self.problems: list[RuleError] = []
        self.refresh()

    def refresh(self) -> None:
        """List the files again."""
        entries: dict[str, Entry] = {}
        self.problems = []
        shipped = resources.folder("rules")
        for folder, pack in self._sources:
            chosen = set(rule_files(folder, self._families))
            for path, name in rule_files(folder, every=True):
                if name in entries and (problem := rival(path, name, entries[name].path)):
                    self.problems.append(problem)
                entries.setdefault(name, Entry(name, path, pack, (path, name) in chosen, own=folder != shipped))
        self.entries = {name: entries[name] for name in sorted(entries)}

    def directories(self) -> list[Path]:
        """Return the folders of rules with all folders below them."""
        below = (path for folder, _ in self._sources for path in (folder, *folder.rglob("*")))
        return [path for path in below if path.is_dir()]

    @classmethod
    def of(cls, settings: Settings) -> Library:
        """Return the rules in force: those that `kg` ships, those of installed packs, and the user's own."""
        return cls((resources.folder("rules"), *user_folders(settings)), packs(), families_in_force(settings))

    @property
    def in_force(self) -> list[Entry]:
        """The rules that run."""
        return [entry for entry in self.entries.values() if entry.in_force]

    def read(self, name: str) -> RuleFile:
        """Return the file of a rule; raises what `kg.rules.reading.read` raises."""
        entry = self.entries[name]
        changed = changed_at(entry.path)
        cached = self._read.get(name)
        if cached is None or cached[0] != changed:
            cached = self._read[name] = changed, read(entry.path, name, pack=entry.pack)
        return cached[1]

    def read_all(self, entries: Iterable[Entry] | None = None) -> tuple[list[RuleFile], list[RuleError]]:
        """Return the files of some rules, or of those in force, and the errors of those that cannot be read."""
        files, errors = [], [] if entries is not None else list(self.problems)
        for entry in self.in_force if entries is None else entries:
            try:
                files.append(self.read(entry.name))
            except RuleError as error:
                errors.append(error)
        return files, errors

    def with_those_in_force(self, chosen: Iterable[Entry] = ()) -> list[RuleFile]:
        """Return the files of the rules in force and of those chosen; raises the first error."""
        wanted = {entry.name for entry in (*self.in_force, *chosen)}
        files, errors = self.read_all(entry for name, entry in self.entries.items() if name in wanted)
        for error in (*self.problems, *errors):
            raise error
        return files


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
