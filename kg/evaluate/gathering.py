"""Gathering of references from files, and reasons why some cannot be compared."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import Place, UsageError
from kg.evaluate import references
from kg.evaluate.documents import PAGES, Packages, pages_below, read_page

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from kg.evaluate.references import Reference
    from kg.store.interface import Snapshot

ABSENT: Final = "repository not in the store"
OTHER_COMMIT: Final = "another commit than the store's"
_NO_PACKAGE: Final = "page in no package of the store"


@dataclass(frozen=True, slots=True)
class Choice:
    """Options: `closed` references are complete, `package` is the one that pages are about."""

    closed: bool = False
    any_commit: bool = False
    package: str | None = None


@dataclass(frozen=True, slots=True)
class Gathered:
    """The comparable references of a file or folder, and the numbers of others by reason."""

    path: Path
    references: tuple[Reference, ...]
    left_out: Mapping[str, int]


def gather(snapshot: Snapshot, paths: Iterable[Path], choice: Choice) -> tuple[Gathered, ...]:
    """Return the references in files (JSON lines, pages) and in folders of pages.

    Raises UsageError: KG721 an unreadable file, KG723 a page of an unknown package.
    """
    packages = Packages(snapshot)
    commits = {references.owner_and_name(name): commit for name, commit in packages.commits.items()}
    return tuple(_chosen(path, _read(path, packages, choice), commits, choice) for path in paths)


def _chosen(path: Path, reading: references.Reading, commits: Mapping[str, str | None], choice: Choice) -> Gathered:
    left_out, chosen = Counter(reading.left_out), []
    for one in reading.references:
        if one.repository not in commits:
            left_out[ABSENT] += 1
        elif not choice.any_commit and not _same(one.commit, commits[one.repository]):
            left_out[OTHER_COMMIT] += 1
        else:
            chosen.append(one)
    return Gathered(path, tuple(chosen), left_out)


def _same(stated: str | None, read: str | None) -> bool:
    """Return whether a reference is about the commit that was read; one without a commit is assumed to be."""
    return not stated or not read or read.startswith(stated) or stated.startswith(read)


def _read(path: Path, packages: Packages, choice: Choice) -> references.Reading:
    if path.is_dir():
        return _folder(path, packages, choice)
    if path.suffix.lower() not in PAGES:
        return references.read(path, closed=choice.closed)
    spot = packages.called(choice.package) if choice.package else packages.around(path)
    if spot is None:
        message = "this page is in no package of the store"
        raise UsageError("KG723", message, place=Place(str(path)), hint="Name its package with --package.")
    return references.Reading(read_page(path, spot, closed=choice.closed))


def _folder(path: Path, packages: Packages, choice: Choice) -> references.Reading:
    """Read the pages below a folder, each for its package."""
    read: list[Reference] = []
    left_out: Counter[str] = Counter()
    for page in pages_below(path):
        spot = packages.around(page)
        if spot is None:
            left_out[_NO_PACKAGE] += 1
            continue
        try:
            read.extend(read_page(page, spot, closed=choice.closed))
        except UsageError:
            left_out["not readable as UTF-8"] += 1
    return references.Reading(tuple(read), left_out)
