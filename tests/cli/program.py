"""The program as users run it: a process with streams and an exit code of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from forks import start
from patience import patient

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

__all__ = ["Program", "Run"]

_SECONDS: Final = 30
"""Time limit in seconds of a run on an idle machine."""
_READ_LATER: Final = {
    *("COMP_CWORD", "COMP_WORDS", "KG_JOBS", "KG_REMOTE_PASSWORD", "KG_REMOTE_USER", "KG_STORE", "KG_TOKEN"),
    *("XDG_CACHE_HOME", "_KG_COMPLETE"),
}
"""Variables that no module reads at import."""


@dataclass(frozen=True, slots=True)
class Run:
    """The result of a process."""

    code: int
    out: str
    err: str


@dataclass(frozen=True, slots=True)
class Program:
    """Runs `kg` in `folder`, without outside settings."""

    folder: Path

    def __call__(self, *arguments: str, folder: Path | None = None, **environment: str) -> Run:
        """Run `kg` with arguments; `folder` is another working folder, other keywords are environment variables.

        The process is forked from one that has imported `kg`, unless variables are given that Python itself or a
        library may read at start.
        """
        if sys.platform == "linux" and environment.keys() <= _READ_LATER:
            return _forked(arguments, folder or self.folder, _surroundings(environment))
        return self.python("-m", "kg", *arguments, folder=folder, **environment)

    def python(self, *arguments: str, folder: Path | None = None, **environment: str) -> Run:
        """Run a new Python in the same environment."""
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=folder or self.folder,
            env=_surroundings(environment),
            capture_output=True,
            text=True,
            check=False,
            timeout=patient(_SECONDS),
        )
        return Run(done.returncode, done.stdout, done.stderr)


def _surroundings(environment: Mapping[str, str]) -> dict[str, str]:
    clean = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    return {**clean, "COLUMNS": "80", **environment}


def _forked(arguments: Sequence[str], folder: Path, environment: Mapping[str, str]) -> Run:
    with start("-m", "kg", *arguments, folder=folder, environment=environment) as process:
        out, err = process.communicate(timeout=patient(_SECONDS))
        return Run(process.wait(), out, err)
