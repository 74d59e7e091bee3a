"""Output of `kg rules`, compared with the files in `golden/rules/`; see test_golden.py for how to write them.

The rules are those of `rules_case/`, the store is that of the rover.
"""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path
from typing import Final

import pytest
from cli.rover import build
from cli.test_golden import said
from pyoxigraph import NamedNode

from kg.graph.iris import Iris
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout

GOLDEN: Final = Path(__file__).parent / "golden" / "rules"
CASES: Final = sorted(GOLDEN.glob("*.txt"))
DURATION: Final = re.compile(r"\b(?:\d+\.\d+(?:e-\d+)?|\d+e-\d+)\b(?!\.)")
"""Seconds."""
SHARE: Final = re.compile(r"\b\d+%")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with rules and the store of the rover, before any run of rules."""
    folder = tmp_path_factory.mktemp("built") / "rover"
    shutil.copytree(Path(__file__).parent / "rules_case", folder)
    build(folder / ".kg")
    with EmbeddedStore(Layout(folder / ".kg")).write("test") as transaction:
        transaction.drop_graph(NamedNode(Iris().graph("inferred")))
    return folder


@pytest.fixture
def rover(built: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a copy of the folder, as the working folder."""
    folder = tmp_path / "rover"
    shutil.copytree(built, folder)
    monkeypatch.chdir(folder)
    for name in [name for name in os.environ if name.startswith("KG_") and name != "KG_WRITE_GOLDEN"]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("COLUMNS", "100")
    return folder


def masked(text: str) -> str:
    """Return the output of a command without durations."""
    return "\n".join(
        SHARE.sub("#%", DURATION.sub("#", line)) if re.search(r"second|\ds\b|\d s\b|\s\d+\.\d{4}\b", line) else line
        for line in text.split("\n")
    )


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_output(case: Path, rover: Path) -> None:
    """The commands at the top of the file, of which the last is shown, give its streams and exit code."""
    expected = case.read_text(encoding="utf-8")
    commands = re.findall(r"^\$ (.*)$", expected.partition("\n[")[0], re.MULTILINE)
    before = "".join(f"$ {command}\n" for command in commands[:-1])
    for command in commands[:-1]:
        said(command, rover)
    found = before + masked(said(commands[-1], rover))
    if os.environ.get("KG_WRITE_GOLDEN"):
        case.write_text(found, encoding="utf-8")
        expected = found
    assert found == expected
