"""Small workspaces as folders: `kg lint` checks `cases/systems/CASE/` and reports the lines of `expected.txt`.

A line is severity, code, file with line, and message. Some cases are faults that `kg lint` found in public robots.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import kg

CASES = sorted(path.parent for path in (Path(__file__).parent / "cases" / "systems").glob("*/expected.txt"))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_findings_of_a_workspace(case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Exactly the findings expected by the case."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    sources = shutil.copytree(case, tmp_path / "src", ignore=shutil.ignore_patterns("expected.txt"))
    monkeypatch.chdir(tmp_path)
    assert [_line(one) for one in kg.findings([sources])] == case.joinpath("expected.txt").read_text().splitlines()


def _line(found: dict[str, object]) -> str:
    place = f"{found['file']}:{found['line']}" if found["line"] else found["file"]
    return f"{found['severity']} {found['code']} {place} {found['message']}"
