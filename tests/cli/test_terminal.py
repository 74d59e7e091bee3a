from __future__ import annotations

import io
import os
import pty
import re
import subprocess
from typing import TYPE_CHECKING, Final

import pytest
from cli.rover import build
from forks import programs
from rich.console import Console
from workspaces import copied, example

from kg.cli import output
from kg.cli.commands import lists
from kg.resources import folder

if TYPE_CHECKING:
    from pathlib import Path

COLUMNS: Final = 80
_ESCAPE: Final = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b\]8;[^\x1b]*\x1b\\")


def on_terminal(where: Path, *arguments: str, **environment: str) -> str:
    """Return the output of `kg` on a terminal of eighty columns."""
    here, there = pty.openpty()
    clean = {name: value for name, value in os.environ.items() if not name.startswith("KG_") and name != "NO_COLOR"}
    process = subprocess.Popen(
        [programs() / "kg", *arguments],
        cwd=where,
        env={**clean, "TERM": "xterm-256color", "COLUMNS": str(COLUMNS), "LINES": "40", **environment},
        stdin=there,
        stdout=there,
        stderr=there,
    )
    os.close(there)
    shown = b""
    while True:
        try:
            part = os.read(here, 4096)
        except OSError:
            break
        if not part:
            break
        shown += part
    process.wait()
    os.close(here)
    return shown.decode()


def test_numbers_are_dropped_before_names_are_broken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A list that does not fit leaves out places and numbers, and shows every name whole."""
    monkeypatch.setattr(output, "line_width", lambda: 60)
    names = ("regulated_pursuit_controller", "RegulatedPursuitController")
    row = (*names, "plugin", 2, 1, 1, 0, 0, 0, 25, "controller/src/regulated_pursuit_controller.cpp:35")
    drawn = io.StringIO()
    Console(file=drawn, width=60).print(output.make_table(lists.table_columns("nodes"), [row]))
    assert f"{names[0]}  {names[1]}" in drawn.getvalue()


@pytest.mark.parametrize(
    "arguments",
    [["nodes"], ["packages"], ["topics"], ["node", "rover_base/driver", "--all"], ["stats"], ["status"], ["--help"]],
)
def test_nothing_is_wider_than_the_terminal(tmp_path: Path, arguments: list[str]) -> None:
    """Tables fit eighty columns, with texts shortened if necessary."""
    build(tmp_path / ".kg")
    lines = _ESCAPE.sub("", on_terminal(tmp_path, *arguments)).splitlines()
    tables = [line for line in lines if not line.startswith("note: ")]
    assert len(tables) > 2
    assert max(map(len, tables)) <= COLUMNS


def test_lists_are_tables_in_colour(tmp_path: Path) -> None:
    """A terminal shows a header, a rule and bold names; NO_COLOR removes the colours."""
    build(tmp_path / ".kg")
    assert "\x1b[1m" in on_terminal(tmp_path, "nodes")
    plain = on_terminal(tmp_path, "nodes", NO_COLOR="1")
    assert "───" in plain
    assert "note: 3 nodes" in plain
    assert not re.search(r"\x1b\[3[0-9]m", plain)


def test_places_lead_to_the_file(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Places are terminal links (OSC 8), for nodes, in results and below hits."""
    copied(example(tmp_path_factory) / ".kg", tmp_path / ".kg")
    for arguments in (["node", "base_controller"], ["query", "demo/laser-scans"], ["search", "laser scan"]):
        assert re.search(r"\x1b\]8;[^;]*;file://[^\x1b]*\.cpp\x1b\\", on_terminal(tmp_path, *arguments)), arguments


def test_a_build_shows_a_bar_and_then_the_sums(tmp_path: Path) -> None:
    """The bar counts packages and disappears; no line is written for each package."""
    shown = on_terminal(tmp_path, "build", str(folder("examples") / "workspace"))
    assert "/5" in shown
    assert "━" in shown
    assert "read 5 packages of 1 source" in shown
    assert "read rover_core: " not in shown


def test_a_picture_is_not_poured_over_the_terminal(tmp_path: Path) -> None:
    """On a terminal the picture is written to a file named after the node."""
    build(tmp_path / ".kg")
    assert "wrote planner.svg" in on_terminal(tmp_path, "node", "planner", "--picture")
    assert (tmp_path / "planner.svg").read_text().startswith("<svg ")
