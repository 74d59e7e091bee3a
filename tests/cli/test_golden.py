"""Output of commands, compared with the reviewed files in `golden/`.

A file contains a command, its exit code and its two streams. After an intended change, write them again with
`KG_WRITE_GOLDEN=1 pytest tests/cli/test_golden.py` and read the difference.
"""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path
from typing import Final

import pytest
from cli.rover import build
from typer.testing import CliRunner

from kg.cli.app import app

OF_TYPE: Final = """\
# Who publishes a type
#
# On any topic.
#
# @param type string "geometry_msgs/Twist" the type of the messages

SELECT DISTINCT ?node ?topic ?type ?file ?line {
  VALUES ?type { UNDEF }
  ?n rnkg:name ?node ; ros:hasComponent ?end .
  ?end a ros:Publisher ; rnkg:implicit false ; rnkg:name ?topic ; ros:hasMessage/rdfs:label ?type ;
    rnkg:path ?file ; rnkg:line ?line
} ORDER BY ?node ?topic ?file
"""
GOLDEN: Final = Path(__file__).parent / "golden"
CASES: Final = sorted(GOLDEN.glob("*.txt"))


@pytest.fixture(scope="module")
def rover(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the store of the rover."""
    folder = tmp_path_factory.mktemp("rover")
    build(folder / ".kg")
    (folder / "mine").mkdir()
    (folder / "mine" / "of-type.rq").write_text(OF_TYPE)
    return folder


@pytest.fixture(autouse=True)
def _surroundings(rover: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(rover)
    for name in [name for name in os.environ if name.startswith("KG_") and name != "KG_WRITE_GOLDEN"]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("COLUMNS", "100")


def said(command: str, folder: Path) -> str:
    """Return the output and the exit code of a command, with the working folder written as `FOLDER`."""
    result = CliRunner().invoke(app, shlex.split(command)[1:])
    text = f"$ {command}\n[{result.exit_code}]\n----- stdout\n{result.stdout}----- stderr\n{result.stderr}"
    return re.sub(r" in \d+\.\d+ s$", " in # s", text.replace(str(folder), "FOLDER"), flags=re.MULTILINE)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_output(case: Path, rover: Path) -> None:
    """The command in the first line gives the streams and the exit code in the file."""
    expected = case.read_text(encoding="utf-8")
    command = expected.partition("\n")[0].removeprefix("$ ")
    found = said(command, rover)
    if os.environ.get("KG_WRITE_GOLDEN"):
        case.write_text(found, encoding="utf-8")
        expected = found
    assert found == expected
