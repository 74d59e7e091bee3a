"""Output of commands about launch files, compared with the files in `golden/systems/`; see test_golden.py."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Final

import pytest
from cli.test_golden import said
from workspaces import example

from kg.api import instances
from kg.resources import folder

GOLDEN: Final = Path(__file__).parent / "golden" / "systems"
CASES: Final = sorted(GOLDEN.glob("*.txt"))


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the example workspace and the store built from it."""
    return example(tmp_path_factory, "robots")


@pytest.fixture(autouse=True)
def _surroundings(robots: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(robots)
    for name in [name for name in os.environ if name.startswith("KG_") and name != "KG_WRITE_GOLDEN"]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("COLUMNS", "120")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_output(case: Path, robots: Path) -> None:
    """The command at the top of the file gives its streams and exit code."""
    expected = case.read_text(encoding="utf-8")
    match = re.match(r"\$ (.*)\n", expected)
    assert match is not None
    found = said(match[1], robots).replace(str(folder("rules").parent), "KG")
    if os.environ.get("KG_WRITE_GOLDEN"):
        case.write_text(found, encoding="utf-8")
        expected = found
    assert found == expected


def test_python_gets_what_the_command_writes(robots: Path) -> None:
    """`kg.instances` returns the instances of a launch file, evaluated with other arguments if given."""
    launch = "rover_robot/launch/rover.launch"
    names = [one["name"] for one in instances(launch, store=robots / ".kg")]
    assert "/rover1/camera_monitor" in names
    changed = instances(launch, arguments={"name": "second", "camera": "false"}, store=robots / ".kg")
    assert [one["name"] for one in changed] == [
        name.replace("rover1", "second") for name in names if not name.endswith("camera_monitor")
    ]
