"""Repositories to fetch: addresses from a list, validated before git gets them, and their folders."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from kg.corpus.git import repository_name
from kg.corpus.sources import address_problem, listed, parse_source

_PROTOCOLS: Final = {"https": "https", "http": "http:https", "ssh": "ssh", "git": "git", "file": "file"}
"""Schemes of addresses, and the protocols allowed for each: a server cannot redirect to others."""
_PART: Final = re.compile(r"(?!-)[A-Za-z0-9._+~-]+")


@dataclass(frozen=True, slots=True)
class Wanted:
    """A repository to fetch: its `name` (host/owner/name, also its folder), address, and optional ref.

    `problem` is why it is refused; empty if it may be fetched.
    """

    name: str
    url: str
    ref: str | None = None
    problem: str = ""


def read_wanted(path: Path) -> tuple[Wanted, ...]:
    """Return the repositories in a list: one address per line, `URL` or `URL@REF`, comments after `#`.

    Raises SourceError: KG101 an unreadable file.
    """
    return wanted_among(entry for _, entry in listed(path, "repositories"))


def wanted_among(addresses: Iterable[str]) -> tuple[Wanted, ...]:
    """Return the repositories of some addresses without duplicates.

    Refused are those whose folder belongs to another repository or another ref, differs from another only in case, or
    is inside another.
    """
    by_name: dict[str, Wanted] = {}
    for one in map(_wanted, addresses):
        earlier = by_name.setdefault(one.name, one)
        # Names with a host determine the address; those of local repositories do not.
        urls = {each.url.rstrip("/").removesuffix(".git") for each in (one, earlier)}
        if one.ref != earlier.ref or (one.name.startswith("local/") and len(urls) > 1):
            whole = _whole(one)
            by_name.setdefault(
                whole, Wanted(whole, one.url, one.ref, f"its folder {one.name} is that of {_whole(earlier)}")
            )
    folders: dict[str, str] = {}
    for name, one in by_name.items():
        first = folders.setdefault(name.casefold(), name)
        above = next((name[:end] for end in range(len(name)) if name[end] == "/" and name[:end] in by_name), None)
        if not one.problem and (first != name or above):
            problem = f"its folder is in that of {above}" if above else f"its folder is that of {first} but for case"
            by_name[name] = Wanted(name, one.url, one.ref, problem)
    return tuple(by_name.values())


def _whole(one: Wanted) -> str:
    return f"{one.url}@{one.ref}" if one.ref else one.url


def _wanted(address: str) -> Wanted:
    source = parse_source(address)
    if " " in source.address:
        problem = "the address holds blanks"
    else:
        problem = address_problem(source.address, source.ref, _PROTOCOLS)
    if not problem and ".." in source.address.split("/"):
        problem = "the address leads out of itself"
    name = (
        repository_name(source.address) or f"local/{source.address.rstrip('/').rpartition('/')[2].removesuffix('.git')}"
    )
    parts = name.split("/")
    if not problem and not all(_PART.fullmatch(part) and part.strip(".") and part.lower() != ".git" for part in parts):
        problem = f"{name!r} is not a valid folder name"
    return Wanted(address if problem else name, source.address, source.ref, problem)


def protocols(url: str) -> str:
    """Return the protocols that git may use for an address, as `GIT_ALLOW_PROTOCOL`."""
    return _PROTOCOLS.get(url.partition("://")[0].lower(), "ssh")
