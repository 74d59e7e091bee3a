"""One build of a whole corpus: by two workers, with results kept, so that a killed build goes on where it was."""

from __future__ import annotations

import re
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Final

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build"))

from measuring import Measurement, measure, python

from kg.corpus.fetching.git import folder_bytes
from kg.corpus.fetching.lock import FETCHED, Lock, write_lock

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["HEAD", "build", "failures", "row", "subset"]

_CODE: Final = re.compile(r"^\s*\S.*: (KG\d{3}) ", re.MULTILINE)
_SUFFIXES: Final = {".cpp", ".cc", ".cxx", ".hpp", ".h", ".hh", ".py"}
HEAD: Final = (
    "| repositories | files / code | processor time | wall time | peak of all processes | store and cache / results |\n"
    "|---|---|---|---|---|---|"
)


def subset(lock: Lock, first: int | None, most_code: int | None, name: str) -> Lock:
    """Return a lock file of the first repositories, in the order of their names, with at most so many bytes of code."""
    if first is None and most_code is None:
        return lock
    entries = [entry for entry in lock.entries if entry.state == FETCHED]
    if most_code is not None:
        entries = [entry for entry in entries if code_bytes(lock.folder(entry)) <= most_code]
    return write_lock(lock.path.with_name(f"{name}.lock.toml"), entries[:first])


def code_bytes(checkout: Path) -> int:
    """Return the size of all C++ and Python in a checkout."""
    files = (path for path in checkout.rglob("*") if path.suffix in _SUFFIXES)
    return sum(path.stat().st_size for path in files if path.is_file() and not path.is_symlink())


def build(lock: Lock, store: Path, artifacts: Path, jobs: int, kill_after: float | None) -> Iterator[Measurement]:
    """Build what a lock file names; with `kill_after` kill the first build after so many seconds and build again."""
    where = ("--store", str(store), "--cluster", f"local:{jobs}", "--artifacts", str(artifacts))
    command = python("-m", "kg", "build", "--corpus", str(lock.path), *where, "--problems")
    if kill_after is not None:
        yield measure(command, kill_after=kill_after)
    yield measure(command)


def row(lock: Lock, store: Path, artifacts: Path, measured: Measurement) -> str:
    """Return the row of a table in Markdown."""
    fetched = [entry for entry in lock.entries if entry.state == FETCHED]
    code = sum(code_bytes(lock.folder(entry)) for entry in fetched)
    cells = (
        f"{len(fetched)}{' (killed)' if measured.code < 0 else ''}",
        f"{sum(entry.bytes for entry in fetched) / 1e6:,.0f} / {code / 1e6:,.0f} MB",
        f"{measured.cpu:,.0f} s",
        f"{measured.seconds:,.0f} s",
        f"{measured.megabytes:,.0f} MB",
        f"{folder_bytes(store) / 1e6:,.0f} / {folder_bytes(artifacts) / 1e6:,.0f} MB",
    )
    return f"| {' | '.join(cells)} |"


def failures(lock: Lock, words: str) -> Counter[str]:
    """Count what failed: states of the lock file, and codes that the build reported."""
    states = Counter(entry.state for entry in lock.entries if entry.state != FETCHED)
    return states + Counter(match[1] for match in _CODE.finditer(words))
