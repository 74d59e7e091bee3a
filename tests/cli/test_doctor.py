from __future__ import annotations

import json
from shutil import which
from typing import TYPE_CHECKING

import pytest
from cli.rover import build

from kg.cli.commands.doctor import checks as checked
from kg.server import libraries
from kg.settings import load

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program


def checks(out: str) -> dict[str, dict[str, str]]:
    """Return the checks of `kg doctor --json` by subject."""
    return {found["subject"]: found for found in map(json.loads, out.splitlines())}


@pytest.mark.skipif(not which("git"), reason="git is not installed")
def test_a_healthy_installation_has_nothing_wrong(kg: Program, tmp_path: Path) -> None:
    """All checks pass, and the store is listed with its size."""
    build(tmp_path / ".kg")
    run = kg("doctor", "--json", KG_JOBS="2")
    found = checks(run.out)
    assert run.code == 0
    assert "518 quads in 4 graphs" in found["store"]["finding"]
    assert {found[name]["state"] for name in ("Python", "kg", "pyoxigraph", "typer", "git", "writer", "disk")} == {"ok"}
    assert found["setting jobs"]["finding"] == "2 (from KG_JOBS)"


@pytest.mark.skipif(not which("git"), reason="git is not installed")
def test_a_damaged_store_is_wrong_and_gets_its_way_out(kg: Program, tmp_path: Path) -> None:
    """A problem is marked, with instructions below it, and sets the exit code."""
    build(tmp_path / ".kg")
    (tmp_path / ".kg" / "current").write_text("rubbish")
    run = kg("doctor")
    assert run.code == 1
    assert "wrong  store" in run.out
    assert "kg build" in run.out.partition("wrong  store")[2].splitlines()[1]
    assert run.err == "1 thing is wrong\n"


def test_a_missing_program_is_wrong(kg: Program) -> None:
    """Without git on the path, commits cannot be determined."""
    run = kg("doctor", "--json", PATH="/nowhere")
    assert run.code == 1
    assert checks(run.out)["git"]["state"] == "wrong"
    assert checks(run.out)["Java"]["state"] == "note"


def test_missing_libraries_of_the_pages_are_reported(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An installation made without Node.js reports that, and how to complete it."""
    monkeypatch.setattr(libraries, "_VENDOR", tmp_path)
    libraries._manifest.cache_clear()
    try:
        found = {one.subject: one for one in checked(load({}, environment={}, folder=tmp_path))}["pages"]
    finally:
        libraries._manifest.cache_clear()
    assert found.state == "note"
    assert "Node.js" in found.way_out


def test_no_store_is_no_fault(kg: Program) -> None:
    """A missing store is fine before the first build, unless one was named."""
    assert checks(kg("doctor", "--json").out)["store"]["state"] == "note"
    named = kg("doctor", "--json", "--store", "gone")
    assert named.code == 1
    assert checks(named.out)["store"]["state"] == "wrong"
