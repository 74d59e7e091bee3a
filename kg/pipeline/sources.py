"""Resolve names of users (folders, git addresses, lists of both) to scanned sources."""

from __future__ import annotations

import hashlib
import os
import re
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from kg.corpus.sources import ListedSource, fetch_source, is_address, parse_source, read_list
from kg.corpus.workspace import Source, scan_tree
from kg.errors import Place, SourceError, choices

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.pipeline.report import Report
    from kg.settings import Settings

_ROS_VARIABLES = (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share"))
"""Search paths of ROS 1 and ROS 2, and the folder in each that contains a folder per package."""


class LostSourceError(Exception):
    """No worker of a cluster could fetch the source of a folder, of which a package needs files."""

    def __init__(self, folder: str, reason: str) -> None:
        super().__init__(reason)
        self.folder = folder


def installed_folders(settings: Settings) -> tuple[Path, ...]:
    """Return the folders of installed packages: those of the settings, else those of the ROS environment."""
    if settings.installed:
        return settings.installed
    named = (
        Path(part) / below
        for variable, below in _ROS_VARIABLES
        for part in os.environ.get(variable, "").split(os.pathsep)
        if part
    )
    return tuple(dict.fromkeys(folder for folder in named if folder.is_dir()))


def gather(
    named: Iterable[str],
    checkouts: Path,
    report: Report,
    *,
    again: bool = False,
    elsewhere: Mapping[str, Source] = MappingProxyType({}),
) -> tuple[Source, ...]:
    """Return the sources for `named`, each once; a workspace with several checkouts gives one for each.

    Git addresses (`URL`, `URL@ref`) are cloned into the folder `checkouts`. With `again` the names come from earlier
    builds: if one cannot be fetched, the existing clone is used. `elsewhere` contains the sources of folders that other
    machines have scanned.

    Raises:
        SourceError: KG101 for a missing folder, KG102 if none has a package, KG103 if git fails.
    """
    sources: dict[str, Source] = {}
    texts = tuple(named)
    for text in texts:
        if text in elsewhere:
            _add(sources, elsewhere[text])
            continue
        for listed in _listed(text):
            for source in scan_tree(_folder(listed, checkouts, report, again=again)):
                _add(sources, source)
    if not any(source.packages for source in sources.values()):
        places = ", ".join(str(source.root) for source in sources.values())
        message = f"found no ROS package in {places or ', '.join(texts) or 'the named folders'}"
        excluded = [one for source in sources.values() for one in source.problems if one.path != "."]
        raise SourceError("KG102", message, hint=choices([f"{one.path}: {one.message}." for one in excluded]) or None)
    for source in sources.values():
        report.source(source.repository, len(source.packages), source.problems)
    return tuple(sources.values())


def folders(named: Iterable[str]) -> tuple[str, ...]:
    """Return the folders among `named`; earlier sources in them that no longer exist are removed."""
    listed = (one.address for text in named for one in _listed(text))
    return tuple(address for address in listed if not is_address(address))


def _listed(text: str) -> Iterator[ListedSource]:
    """Yield the sources of `text`: an address, a folder, or the entries of a list file."""
    if is_address(text):
        yield parse_source(text)
        return
    path = Path(text).expanduser().absolute()
    if path.is_file():
        yield from read_list(path)
    elif path.is_dir():
        yield ListedSource(str(path))
    else:
        hint = "Check the spelling; if it was read before and is gone for good, `kg forget` its source."
        raise SourceError("KG101", "no such folder, address or list of sources", place=Place(text), hint=hint)


def _folder(listed: ListedSource, checkouts: Path, report: Report, *, again: bool) -> Path:
    if not is_address(listed.address):
        return Path(listed.address)
    words = re.sub(r"[^A-Za-z0-9._-]+", "+", listed.address.partition("://")[2] or listed.address)
    unique = hashlib.blake2b(f"{listed.address}@{listed.ref}".encode(), digest_size=4).hexdigest()
    target = checkouts / f"{words[-80:]}-{unique}"
    try:
        return fetch_source(listed.address, listed.ref, target, report.fetching)
    except SourceError as error:
        if not (again and (target / ".git").exists()):
            raise
        report.fetching(f"{error.message}; it is taken as it was fetched last")
        return target


def _add(sources: dict[str, Source], source: Source) -> None:
    """Add a source: two folders of one checkout are one source, two checkouts of one repository are different ones."""
    name, number = source.repository.name, 1
    while name in sources and sources[name].root != source.root:
        number += 1
        name = f"{source.repository.name}~{number}"
    if name in sources:
        source = _joined(sources[name], source)
    sources[name] = replace(source, repository=replace(source.repository, name=name))


def _joined(first: Source, second: Source) -> Source:
    packages = {package.path: package for package in (*first.packages, *second.packages)}
    owned = {entry.path for package in packages.values() for entry in package.files}
    loose = {entry.path: entry for entry in (*first.loose, *second.loose) if entry.path not in owned}
    return replace(
        first,
        packages=tuple(packages[path] for path in sorted(packages)),
        loose=tuple(loose[path] for path in sorted(loose)),
        problems=tuple(dict.fromkeys((*first.problems, *second.problems))),
        links=tuple(dict.fromkeys((*first.links, *second.links))),
    )
