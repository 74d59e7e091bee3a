"""The program as users run it: a process with its own streams and exit code."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["Program", "Run"]


@dataclass(frozen=True, slots=True)
class Run:
    """How a process ended."""

    code: int
    out: str
    err: str


@dataclass(frozen=True, slots=True)
class Program:
    """Runs `kg` in `folder`, without settings from outside."""

    folder: Path

    def __call__(self, *arguments: str, folder: Path | None = None, **environment: str) -> Run:
        """Run `kg` with arguments; `folder` is another working folder, other keywords are environment variables."""
        return self.python("-m", "kg", *arguments, folder=folder, **environment)

    def python(self, *arguments: str, folder: Path | None = None, **environment: str) -> Run:
        """Run Python in the same surroundings."""
        clean = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=folder or self.folder,
            env={**clean, "COLUMNS": "80", **environment},
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )
        return Run(done.returncode, done.stdout, done.stderr)
