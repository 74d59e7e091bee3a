"""Calls of `kg` as a user makes them."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

FINDINGS = 1
"""The exit code that only says that there are findings or problems."""


def build(workspace: Path, store: Path) -> None:
    """Build a workspace into a store of its own."""
    _kg(["build", str(workspace), "--store", str(store)])


def answers(
    command: str, launch: Path, store: Path, environment: Mapping[str, str], arguments: Mapping[str, str] = {}
) -> list[dict[str, Any]]:
    """Return what `kg COMMAND --launch FILE --json` says with these arguments, an object a line."""
    given = [part for name, value in environment.items() for part in ("--env", f"{name}={value}")]
    given += [part for name, value in arguments.items() for part in ("--arg", f"{name}:={value}")]
    text = _kg([command, "--launch", str(launch), "--json", "--store", str(store), *given])
    return [json.loads(line) for line in text.splitlines() if line.strip()]


def _kg(arguments: list[str]) -> str:
    command = [sys.executable, "-m", "kg", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, FINDINGS):
        raise SystemExit(f"kg {' '.join(arguments)} ended with {done.returncode}:\n{done.stderr.strip()}")
    return done.stdout
