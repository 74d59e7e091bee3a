"""Sources of a build: git repositories fetched into a cache, folders, and files that list sources."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from kg.corpus.git import run_git, without_password
from kg.errors import Place, SourceError

_URL: Final = re.compile(r"^(?P<scheme>[A-Za-z][A-Za-z0-9+.-]*)://(?P<authority>[^/]*)(?P<path>/.*)?$")
_SCP: Final = re.compile(
    r"^[A-Za-z0-9_.][A-Za-z0-9_.-]*@(?P<authority>[A-Za-z0-9_.][A-Za-z0-9_.-]*):(?!/?/)(?P<path>\S+)$"
)
_SCHEMES: Final = ("https", "ssh", "git", "file")
_REF: Final = re.compile(r"(?!-)[^\s:^~?*\[\\\x00-\x20\x7f]+")
_FETCH_SECONDS: Final = 3600.0


@dataclass(frozen=True, slots=True)
class ListedSource:
    """A source as named by a user: the address of a repository with an optional ref, or a folder (ref None)."""

    address: str
    ref: str | None = None
    line: int | None = None


def is_address(text: str) -> bool:
    """Return whether `text` is the address of a git repository rather than a folder."""
    return bool(_URL.match(text) or _SCP.match(text))


def parse_source(text: str, line: int | None = None) -> ListedSource:
    """Split `URL[@ref]`; in a folder, `@` is part of the name."""
    match = _URL.match(text) or _SCP.match(text)
    if match is None or not match["path"]:
        return ListedSource(text, None, line)
    path, mark, ref = match["path"].partition("@")
    return ListedSource(text[: match.start("path")] + path, ref if mark and ref else None, line)


def address_problem(url: str, ref: str | None, schemes: Collection[str]) -> str:
    """Return why git must not be given an address and a ref; empty if it may."""
    if re.search(r"[\x00-\x1f\x7f]", url):
        return "the address holds control characters"
    if url.startswith("-"):
        return "the address is an option for git"
    if "::" in url.partition("/")[0]:
        return "the address names a program"
    match = _URL.match(url) or _SCP.match(url)
    if match is None or not match["path"]:
        return "not the address of a git repository"
    scheme = match.groupdict().get("scheme")
    if scheme is not None and scheme.lower() not in schemes:
        return f"addresses of the scheme {scheme} are not fetched"
    if match["authority"].rpartition("@")[2].startswith("-"):
        return "the host is an option for ssh"
    if ref is not None and (not _REF.fullmatch(ref) or ".." in ref):
        return f"{ref!r} is not a branch, tag or commit"
    return ""


def read_list(path: Path) -> tuple[ListedSource, ...]:
    """Return the sources listed in a file, one per line, comments after `#`; folders are relative to the file.

    Raises `SourceError` (KG101) for an unreadable file.
    """
    return tuple(
        parse_source(entry, number) if is_address(entry) else ListedSource(str(path.parent / entry), None, number)
        for number, entry in listed(path, "sources")
    )


def listed(path: Path, what: str) -> list[tuple[int, str]]:
    """Return the entries of a list of `what` with their lines, without comments; SourceError (KG101) if unreadable."""
    try:
        text = path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SourceError("KG101", f"the list of {what} {path} cannot be read: {error}") from error
    entries = (re.split(r"(?:^|\s)#", line, maxsplit=1)[0].strip() for line in text.splitlines())
    return [(number, entry) for number, entry in enumerate(entries, 1) if entry]


def fetch_source(url: str, ref: str | None, target: Path, progress: Callable[[str], None] = lambda _: None) -> Path:
    """Fetch one commit of the repository at `url` (a branch, tag or commit `ref`) into the folder `target`.

    Only the files of that commit are fetched, without history and submodules; an existing target is updated. `progress`
    receives status messages. Raises `SourceError` (KG103) with git's message.
    """
    if problem := address_problem(url, ref, _SCHEMES):
        raise SourceError("KG103", problem, place=Place(without_password(url)))
    try:
        if not (target / ".git").exists():
            target.mkdir(parents=True, exist_ok=True)
            run_git(("init", "--quiet"), folder=target)
        progress(f"fetching {without_password(url)}")
        wanted = ("fetch", "--quiet", "--depth=1", "--no-tags", "--no-recurse-submodules", "--", url, ref or "HEAD")
        run_git(wanted, folder=target, timeout=_FETCH_SECONDS, network=True)
        progress(f"checking out {ref or 'the default branch'}")
        run_git(("config", "remote.origin.url", without_password(url)), folder=target)
        run_git(("checkout", "--quiet", "--force", "--detach", "FETCH_HEAD"), folder=target, timeout=_FETCH_SECONDS)
    except FileNotFoundError as error:
        raise SourceError("KG103", "git is not installed", hint="Install git, or give a folder.") from error
    except OSError as error:
        raise SourceError("KG103", f"the cache {target} cannot be written: {error.strerror}") from error
    except subprocess.SubprocessError as error:
        raise SourceError("KG103", f"{without_password(url)} was not fetched: {_words(error)}") from error
    return target


def _words(error: subprocess.SubprocessError) -> str:
    """Return git's error message on one line, without `fatal:`."""
    if not isinstance(error, subprocess.CalledProcessError):
        return "git did not answer in time"
    printed = (error.stderr or b"").decode("utf-8", "replace").splitlines()
    lines = [line.removeprefix("fatal: ").strip() for line in printed if line.strip()]
    return "; ".join(lines[:3]) or f"git ended with {error.returncode}"
