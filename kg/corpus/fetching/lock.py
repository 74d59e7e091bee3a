"""The lock file of a corpus: repositories with their commits, and the reasons of those not fetched.

    version = 1

    [[repository]]
    name = "github.com/owner/robot"
    url = "https://github.com/owner/robot"
    moved = ""
    folder = "github.com/owner/robot"
    branch = "noetic-devel"
    commit = "4f1c..."
    ros = "1"
    bytes = 1234567
    state = "fetched"
    reason = ""

Entries are sorted by name and have all keys, so a change of one repository changes only its lines.
"""

from __future__ import annotations

import json
import os
import re
import tempfile
import tomllib
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Final

from kg.corpus.files import Pin
from kg.corpus.git import describe
from kg.errors import Place, SourceError
from kg.settings import toml_place

VERSION: Final = 1
FETCHED: Final = "fetched"
"""The state of a fetched repository; other states are keywords of the reason."""
_HEAD: Final = """\
# The repositories of a corpus, written by `kg corpus fetch`, which fetches these commits again where this file is.
# `kg build --corpus` builds them. Folders are relative to the folder of this file.

"""
_COMMIT: Final = re.compile(r"(?:[0-9a-f]{40}|[0-9a-f]{64})?")


@dataclass(frozen=True, slots=True)
class Entry:
    """A repository of a corpus.

    `name` is host/owner/name, `moved` the address that the server redirected to, `folder` the place of the files,
    relative to the lock file, `branch` and `commit` the fetched ones (empty before), `ros` the versions of its packages
    (`1`, `2`, `1 2`), `bytes` the size of the files of that commit, `reason` an explanation of the state.
    """

    name: str
    url: str
    moved: str = ""
    folder: str = ""
    branch: str = ""
    commit: str = ""
    ros: str = ""
    bytes: int = 0
    state: str = FETCHED
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Lock:
    """A lock file; `entries` are sorted by name."""

    path: Path
    entries: tuple[Entry, ...] = ()

    def folder(self, entry: Entry) -> Path:
        """Return the folder of the checkout."""
        return self.path.absolute().parent / entry.folder


@dataclass(frozen=True, slots=True)
class Standing:
    """The state of a corpus folder: `present`, `missing` and `drifted` repositories.

    Those that drifted are also present, and have a description of their difference. Those `elsewhere` are fetched by
    workers of a cluster.
    """

    present: tuple[Entry, ...]
    missing: tuple[Entry, ...]
    drifted: tuple[tuple[Entry, str], ...]
    elsewhere: tuple[Entry, ...] = ()


def read_lock(path: Path) -> Lock:
    """Return a lock file.

    Raises SourceError: KG101 an unreadable file, KG132 an invalid one, with the line.
    """
    try:
        text = path.read_text("utf-8")
        content = tomllib.loads(text)
    except OSError as error:
        raise SourceError("KG101", f"the lock file {path} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        message, line, column = toml_place(str(error))
        raise SourceError("KG132", f"this is not TOML: {message}", place=Place(str(path), line, column)) from error
    if content.get("version") != VERSION:
        message = f"its version is {content.get('version')!r}, this `kg` reads {VERSION}"
        raise SourceError("KG132", message, place=Place(str(path)))
    tables = content.get("repository", [])
    heads = [number for number, line in enumerate(text.splitlines(), 1) if line.strip() == "[[repository]]"]
    places = [Place(str(path), line) for line in heads]
    if not isinstance(tables, list):
        raise SourceError("KG132", "`repository` is not a list of tables", place=Place(str(path)))
    entries = [
        _entry(table, places[index] if index < len(places) else Place(str(path))) for index, table in enumerate(tables)
    ]
    return Lock(path, tuple(sorted(entries, key=lambda entry: entry.name)))


def _entry(table: Any, place: Place) -> Entry:
    kinds = {one.name: int if one.name == "bytes" else str for one in fields(Entry)}
    if not isinstance(table, dict):
        raise SourceError("KG132", "the entry is not a table", place=place)
    for key, value in table.items():
        if key not in kinds:
            raise SourceError("KG132", f"unknown key `{key}`", place=place, hint=f"Valid keys: {', '.join(kinds)}.")
        if not isinstance(value, kinds[key]) or isinstance(value, bool):
            raise SourceError("KG132", f"`{key}` is {value!r}, not of type {kinds[key].__name__}", place=place)
    if not table.get("name") or not table.get("url"):
        raise SourceError("KG132", "the entry has no `name` or no `url`", place=place)
    if not _COMMIT.fullmatch(table.get("commit", "")):
        raise SourceError("KG132", f"`commit` is {table['commit']!r}, not a commit", place=place)
    return Entry(**table)


def write_lock(path: Path, entries: Iterable[Entry]) -> Lock:
    """Write a lock file atomically: readers see the old or the new one.

    Raises SourceError: KG132 it cannot be written.
    """
    ordered = tuple(sorted(entries, key=lambda entry: entry.name))
    text = _HEAD + f"version = {VERSION}\n"
    for entry in ordered:
        text += "\n[[repository]]\n"
        text += "".join(f"{key} = {_value(value)}\n" for key, value in asdict(entry).items())
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as stream:
                stream.write(text)
                stream.flush()
                os.fsync(stream.fileno())
            Path(name).chmod(0o644)
            Path(name).replace(path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError as error:
        raise SourceError("KG132", f"{path} cannot be written: {error.strerror}") from error
    return Lock(path, ordered)


def _value(value: str | int) -> str:
    """Return a value as TOML; strings are those of JSON, except that DEL must be escaped."""
    if isinstance(value, str):
        value = value.encode("utf-8", "backslashreplace").decode("utf-8")
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def standing(lock: Lock, *, elsewhere: bool = False) -> Standing:
    """Compare a lock with its folder; entries that were never fetched are missing.

    With `elsewhere`, workers of a cluster fetch the others that are not in the folder.
    """
    present: list[Entry] = []
    missing: list[Entry] = []
    away: list[Entry] = []
    drifted: list[tuple[Entry, str]] = []
    for entry in lock.entries:
        folder = lock.folder(entry)
        pinned = entry.commit and entry.folder
        if not pinned or not (folder / ".git").exists():
            (away if pinned and elsewhere else missing).append(entry)
            continue
        present.append(entry)
        checkout = describe(folder)
        if checkout.commit != entry.commit:
            drifted.append((entry, f"is at {(checkout.commit or 'no commit')[:12]}, not at {entry.commit[:12]}"))
        elif checkout.dirty:
            drifted.append((entry, "files were changed"))
    return Standing(tuple(present), tuple(missing), tuple(drifted), tuple(away))


def checkouts(lock: Lock, state: Standing) -> dict[str, Pin | None]:
    """Return the folders of the present checkouts, and of those elsewhere with their pins, in the order of the file.

    Raises SourceError: KG136 there is none.
    """
    if not state.present and not state.elsewhere:
        message = f"none of the {len(state.missing)} repositories of the lock file is checked out"
        raise SourceError("KG136", message, place=Place(str(lock.path)), hint=f"`kg corpus fetch --lock {lock.path}`")
    pins: dict[str, Pin | None] = {one.name: None for one in state.present}
    pins |= {one.name: Pin(one.name, one.url, one.commit) for one in state.elsewhere}
    return {str(lock.folder(entry)): pins[entry.name] for entry in lock.entries if entry.name in pins}
