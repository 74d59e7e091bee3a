"""Output of `kg lint`, compared with the files in `golden/lint/`; see test_golden.py for how to write them."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path
from socket import gethostname
from typing import Final
from xml.etree import ElementTree as ET

import pytest
from cli.test_golden import said
from lint.robot import write

GOLDEN: Final = Path(__file__).parent / "golden" / "lint"
CASES: Final = sorted(GOLDEN.glob("*.txt"))


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with launch files and a store with findings about them."""
    folder = tmp_path_factory.mktemp("built") / "robot"
    folder.mkdir()
    write(folder)
    shutil.copytree(Path(__file__).parent / "lint_case", folder, dirs_exist_ok=True)
    return folder


@pytest.fixture(autouse=True)
def _surroundings(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(built)
    for name in [name for name in os.environ if name.startswith("KG_") and name != "KG_WRITE_GOLDEN"]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("COLUMNS", "100")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_output(case: Path, built: Path) -> None:
    """The commands at the top of the file, of which the last is shown, give its streams and exit code."""
    expected = case.read_text(encoding="utf-8")
    commands = re.findall(r"^\$ (.*)$", expected.partition("\n[")[0], re.MULTILINE)
    for command in commands[:-1]:
        said(command, built)
    before = "".join(f"$ {command}\n" for command in commands[:-1])
    text = said(commands[-1], built).replace(f"{gethostname()}FOLDER", "FOLDER")
    found = before + re.sub(r'"version": "[^"]+", "rules"', '"version": "#", "rules"', text)
    if os.environ.get("KG_WRITE_GOLDEN"):
        case.write_text(found, encoding="utf-8")
        expected = found
    assert found == expected


def test_results_are_written_for_ament(built: Path) -> None:
    """The file is created with its folders, one case a failure; the exit code is the usual one."""
    file = built / "results" / "robot" / "kg_lint.xunit.xml"
    assert "[1]" in said(f"kg lint --xunit-file {file} --code KG412", built)
    suite = ET.fromstring(file.read_text(encoding="utf-8"))  # noqa: S314 - written by the line above
    assert (suite.get("name"), suite.get("failures")) == ("robot.kg_lint", "1")


def test_a_file_that_cannot_be_written_is_told(built: Path) -> None:
    """A result or a baseline below a file is a usage error."""
    assert "KG003" in said("kg lint --xunit-file kg.toml/x.xml", built)
    assert "KG003" in said("kg lint --write-baseline kg.toml/x.json", built)
