"""Information from git about a folder: name of the repository, commit, branch, remote, and whether it has changes.

`git` is run without hooks, monitors, prompts or the caller's `GIT_*` variables. If it is missing, the files in `.git`
are read instead, which does not detect changes.
"""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path
from typing import Final

from kg.facts import Repository

_SAFE: Final = (
    *("-c", "core.fsmonitor=false"),
    *("-c", "core.hooksPath=/dev/null"),
    *("-c", "safe.directory=*"),
    *("-c", "protocol.ext.allow=never"),
    *("-c", "gc.auto=0"),
)
_PROTOCOLS: Final = "https:ssh:git:file"
_ENVIRONMENT: Final = {
    "GIT_TERMINAL_PROMPT": "0",
    "GIT_OPTIONAL_LOCKS": "0",
    "GIT_NO_LAZY_FETCH": "1",
    "GIT_LFS_SKIP_SMUDGE": "1",
    "LC_ALL": "C",
}
_QUICK_SECONDS: Final = 20.0
_SCP: Final = re.compile(r"^(?:[^@/:\s]+@)?(?P<host>[^/:\s]+):(?!//)(?P<path>.+)$")
_URL: Final = re.compile(
    r"^(?P<scheme>[a-zA-Z][a-zA-Z0-9+.-]*)://(?:[^@/\s]*@)?(?P<host>[^/:\s]*)(?::\d+)?/(?P<path>.*)$"
)


def describe(folder: Path) -> Repository:
    """Return the repository whose root or committed folder is `folder`, else `local/NAME`."""
    top = _toplevel(folder)
    if top is None:
        return Repository(f"local/{folder.name or 'root'}", str(folder))
    try:
        return _ask_git(top)
    except (OSError, subprocess.SubprocessError):
        return _read_git_files(top)


def run_git(
    arguments: tuple[str, ...],
    *,
    folder: Path | None = None,
    timeout: float | None = _QUICK_SECONDS,
    network: bool = False,
) -> str:
    """Return the output of `git`; raises `OSError` if it is missing and `SubprocessError` if it fails or times out.

    Without `network` no protocol is allowed, so a partial clone cannot fetch missing objects.
    """
    done = subprocess.run(  # noqa: S603  (fixed program; addresses and paths follow `--`)
        command(arguments, folder=folder),
        check=True,
        capture_output=True,
        stdin=subprocess.DEVNULL,
        env=environment(_PROTOCOLS if network else "none"),
        timeout=timeout,
    )
    return os.fsdecode(done.stdout)


def command(arguments: tuple[str, ...], *, folder: Path | None = None) -> tuple[str, ...]:
    """Return the command line of `git` with settings that prevent running programs named in a repository."""
    return ("git", *_SAFE, *(("-C", str(folder)) if folder else ()), *arguments)


def environment(protocols: str) -> dict[str, str]:
    """Return the environment of `git`: the caller's without `GIT_*`, and with only these protocols (`https:ssh`)."""
    inherited = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
    return inherited | _ENVIRONMENT | {"GIT_ALLOW_PROTOCOL": protocols}


def repository_name(remote: str) -> str | None:
    """Return `host/owner/name` of a remote's address (https, ssh, scp-like, git); None for one on this machine."""
    address = remote.strip()
    match = _URL.match(address) or _SCP.match(address)
    if match is None or not match["host"] or match.groupdict().get("scheme") == "file":
        return None
    path = "/".join(part for part in match["path"].split("/") if part not in {"", ".", "..", "~"})
    path = path.removesuffix(".git")
    return f"{match['host'].lower()}/{path}" if path else None


def without_password(text: str) -> str:
    """Return a text without the user and password of addresses in it."""
    return re.sub(r"(?<=://)[^@/\s]*@", "", text)


def _toplevel(folder: Path) -> Path | None:
    """Return the root of the checkout: the folder, or one above it if the folder is committed there."""
    if (folder / ".git").exists():
        return folder
    above = next((parent for parent in folder.parents if (parent / ".git").exists()), None)
    if above is None:
        return None
    within = folder.relative_to(above).as_posix()
    try:
        listed = run_git(("ls-tree", "-d", "--name-only", "HEAD", "--", within), folder=above)
    except (OSError, subprocess.SubprocessError):
        return None
    return above if listed.strip() else None


def _ask_git(top: Path) -> Repository:
    try:
        commit, branch = run_git(("rev-parse", "HEAD", "--abbrev-ref", "HEAD"), folder=top).splitlines()
    except subprocess.CalledProcessError:
        commit, branch = "", "HEAD"
    try:
        listed = run_git(("config", "--local", "--includes", "--null", "--list"), folder=top)
    except subprocess.CalledProcessError:
        listed = ""
    configured = [(key, value) for key, _, value in (entry.partition("\n") for entry in listed.split("\0")) if key]
    remotes = {
        key.removeprefix("remote.").removesuffix(".url"): value
        for key, value in configured
        if key.startswith("remote.") and key.endswith(".url")
    }
    remote = _pick_remote(remotes)
    name, changed = _name(top, remote), _changed(top, {key for key, _ in configured})
    return Repository(name, str(top), commit or None, remote, None if branch == "HEAD" else branch, changed)


def _changed(top: Path, keys: set[str]) -> bool:
    """Return whether tracked files differ from the commit.

    Comparing would run the filter programs in the repository's settings, so these are disabled first.
    """
    filters = sorted(key for key in keys if key.startswith("filter.") and key.endswith((".clean", ".process")))
    off = tuple(word for key in filters for word in ("-c", f"{key}="))
    needless = tuple(word for key in filters for word in ("-c", f"{key.rpartition('.')[0]}.required=false"))
    status = ("status", "--porcelain", "--untracked-files=no", "--ignore-submodules=all")
    return bool(run_git((*off, *needless, *status), folder=top))


def _pick_remote(remotes: dict[str, str]) -> str | None:
    chosen = remotes.get("origin") or next((remotes[name] for name in sorted(remotes)), None)
    return without_password(chosen) if chosen else None


def _name(top: Path, remote: str | None) -> str:
    return (repository_name(remote) if remote else None) or f"local/{top.name or 'root'}"


def _read_git_files(top: Path) -> Repository:
    folder = top / ".git"
    if folder.is_file() and (text := _read(folder)).startswith("gitdir: "):  # of a worktree or submodule
        folder = top / text.removeprefix("gitdir: ")
    head = _read(folder / "HEAD")
    branch = head.removeprefix("ref: refs/heads/") if head.startswith("ref: refs/heads/") else None
    commit = _resolve_reference(folder, head.removeprefix("ref: ")) if head.startswith("ref: ") else head
    remote = _pick_remote(_configured_remotes(_common_folder(folder)))
    return Repository(_name(top, remote), str(top), commit or None, remote, branch)


def _common_folder(folder: Path) -> Path:
    common = _read(folder / "commondir")
    return folder / common if common else folder


def _resolve_reference(folder: Path, reference: str) -> str:
    common = _common_folder(folder)
    loose = _read(folder / reference) or _read(common / reference)
    if loose:
        return loose
    lines = (line.split(" ") for line in _read(common / "packed-refs").splitlines())
    return next((parts[0] for parts in lines if parts[1:] == [reference]), "")


def _configured_remotes(folder: Path) -> dict[str, str]:
    remotes: dict[str, str] = {}
    section = None
    for line in _read(folder / "config").splitlines():
        header = re.match(r'\s*\[remote "(.*)"\]', line)
        if header or line.lstrip().startswith("["):
            section = header[1] if header else None
        key, _, value = line.partition("=")
        if section and key.strip() == "url":
            remotes[section] = value.strip()
    return remotes


def _read(path: Path) -> str:
    try:
        return path.read_text("utf-8", "surrogateescape").strip()
    except OSError:
        return ""
