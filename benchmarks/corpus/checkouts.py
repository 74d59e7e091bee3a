"""Checkouts of a corpus from git directories of this machine, pinned in a lock file as `kg corpus fetch` does."""

from __future__ import annotations

import os
import shutil
import subprocess
from typing import TYPE_CHECKING

from bugs.workspaces import MissingError, git_folder, unpack

from kg.corpus.fetching.lock import FETCHED, Entry, Lock, read_lock, write_lock
from kg.corpus.fetching.one import is_at_commit, ros_versions
from kg.corpus.git import environment, run_git

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from kg.corpus.fetching.wanted import Wanted

__all__ = ["check_out_all"]


def check_out_all(wanted: Iterable[Wanted], mirrors: Path, folder: Path) -> Lock:
    """Check out the default branch of each repository into `folder`, and return the lock file there.

    What is checked out at the commit of its mirror stays as it is. A repository without a usable mirror gets an entry
    with the state `gone`. Files of more than a megabyte, and those that a mirror lacks, are left out.
    """
    path = folder / "corpus.lock.toml"
    known = {entry.name: entry for entry in read_lock(path).entries} if path.exists() else {}
    entries = []
    for one in wanted:
        try:
            entries.append(_entry(one, git_folder(mirrors, one.name.partition("/")[2]), folder, known.get(one.name)))
        except (MissingError, subprocess.SubprocessError) as error:
            entries.append(Entry(one.name, one.url, state="gone", reason=_reason(error)))
    return write_lock(path, entries)


def _entry(one: Wanted, mirror: Path, folder: Path, known: Entry | None) -> Entry:
    commit = run_git(("--git-dir", str(mirror), "rev-parse", "HEAD")).strip()
    target = folder / one.name
    if known and known.state == FETCHED and known.commit == commit and is_at_commit(target, commit):
        return known
    partial = folder / ".partial"
    shutil.rmtree(partial, ignore_errors=True)
    shutil.rmtree(target, ignore_errors=True)
    partial.mkdir(parents=True)
    unpack(mirror, commit, partial)
    size = sum(path.stat().st_size for path in partial.rglob("*") if path.is_file() and not path.is_symlink())
    _make_checkout(partial, mirror, commit, one.url)
    ros = ros_versions(partial)
    target.parent.mkdir(parents=True, exist_ok=True)
    partial.rename(target)
    return Entry(one.name, one.url, folder=one.name, commit=commit, ros=ros, bytes=size)


def _make_checkout(tree: Path, mirror: Path, commit: str, url: str) -> None:
    """Make the files in `tree` a checkout with the objects of the mirror; git ignores files that are left out."""
    run_git(("init", "--quiet"), folder=tree)
    (tree / ".git" / "objects" / "info" / "alternates").write_text(f"{mirror.absolute() / 'objects'}\n")
    (tree / ".git" / "HEAD").write_text(f"{commit}\n")
    run_git(("config", "remote.origin.url", url), folder=tree)
    run_git(("read-tree", "HEAD"), folder=tree, timeout=None)
    absent = run_git(("ls-files", "--deleted", "-z"), folder=tree, timeout=None)
    subprocess.run(
        ("git", "-C", str(tree), "update-index", "--skip-worktree", "-z", "--stdin"),
        input=os.fsencode(absent),
        check=True,
        capture_output=True,
        env=environment("none"),
    )


def _reason(error: Exception) -> str:
    said = getattr(error, "stderr", None)
    return said.decode("utf-8", "replace").strip() if said else str(error)
