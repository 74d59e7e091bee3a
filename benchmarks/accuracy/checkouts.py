"""Checkouts of the repositories that truth records name, at their commits, from git directories of this machine."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

from bugs.workspaces import MissingError, git_folder

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

__all__ = ["check_out"]


def check_out(truths: Iterable[dict[str, Any]], mirrors: Path, folder: Path) -> list[Path]:
    """Check out each repository and commit that truth records name; report those that the mirrors lack.

    Files that a mirror lacks (large ones, as a rule) are missing from the checkout, too.
    """
    named = {(truth["repo"], truth["commit"]) for truth in truths if truth.get("commit")}
    roots = []
    for repository, commit in sorted(named):
        root = folder / f"{repository.replace('/', '+')}@{commit[:7]}"
        try:
            mirror = git_folder(mirrors, repository)
            _git("clone", "--quiet", "--shared", "--no-checkout", str(mirror), str(root))
            _git("-C", str(root), "remote", "set-url", "origin", f"https://github.com/{repository}")
            _git("-C", str(root), "cat-file", "-e", f"{commit}^{{tree}}")
        except MissingError as missing:
            print(f"{repository} at {commit[:7]} is left out: {missing}", file=sys.stderr)
            continue
        command = ["git", "-C", str(root), "-c", "core.hooksPath=/dev/null", "checkout", "--quiet", commit]
        subprocess.run(command, capture_output=True, check=False)  # fails where a file is missing, and goes on
        roots.append(root)
    return roots


def _git(*arguments: str) -> None:
    done = subprocess.run(["git", "-c", "core.hooksPath=/dev/null", *arguments], capture_output=True, check=False)
    if done.returncode:
        raise MissingError(done.stderr.decode(errors="replace").strip() or f"git {arguments[0]} failed")
