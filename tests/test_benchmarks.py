"""Every figure of docs/benchmarks.md is reproducible: its command and its commit exist."""

from __future__ import annotations

import re
import subprocess
from functools import cache
from itertools import pairwise
from typing import Final

import pytest
from repository import ROOT
from test_docs import COMMANDS

PAGE: Final = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
OPEN: Final = "not measured on this version"

_HEADINGS: Final = [*re.finditer(r"^## (.*)\n", PAGE, re.MULTILINE), re.search(r"\Z", PAGE)]
SECTIONS: Final = {
    here[1]: PAGE[here.end() : after.start()] for here, after in pairwise(_HEADINGS) if here is not None and after
}
"""The text of each section by its heading."""


def rows(section: str) -> list[dict[str, str]]:
    """Return the rows of a section's tables, by column."""
    found, columns = [], list[str]()
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        if cells and not columns:
            columns = cells
        elif cells and set(line) - set("|-"):
            found.append(dict(zip(columns, cells, strict=True)))
        columns = columns if cells else []
    return found


@cache
def history() -> tuple[str, ...]:
    """Return the names of all commits before this one; skip where git or the whole history is missing."""
    git = ["git", "-C", str(ROOT)]
    try:
        shallow = subprocess.run([*git, "rev-parse", "--is-shallow-repository"], capture_output=True, check=True)
        listed = subprocess.run([*git, "rev-list", "HEAD"], capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("the history of a git checkout is needed")
    if shallow.stdout.strip() == b"true":
        pytest.skip("this checkout does not have the whole history")
    return tuple(listed.stdout.decode().split())


def test_commits_are_in_the_history() -> None:
    """A commit named by the page is an ancestor of the current one."""
    named = set(re.findall(r"(?<![@\w])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*[0-9])[0-9a-f]{7,40}\b", PAGE))
    assert named
    assert not {one for one in named if not any(commit.startswith(one) for commit in history())}


@pytest.mark.parametrize("heading", SECTIONS)
def test_a_section_names_commands_that_exist(heading: str) -> None:
    """A section has at least one command: an existing benchmark, test file or command of kg."""
    commands = re.findall(r"^ {4}(.*)", SECTIONS[heading], re.MULTILINE)
    assert commands
    for command in (part for line in commands for part in line.split(" && ")):
        words = command.split()
        if words[0] == "kg":
            assert any(name in COMMANDS for name in (" ".join(words[:2]), " ".join(words[:3]))), command
        elif words[0] == "pytest":
            assert all((ROOT / path).is_file() for path in words[1:]), command
        else:
            program = re.match(r"python (?:-m )?benchmarks[./](\w+)", command)
            assert program, command
            assert (ROOT / "benchmarks" / program[1] / "__main__.py").is_file(), command


@pytest.mark.parametrize("heading", SECTIONS)
def test_a_figure_has_its_commit_or_is_marked(heading: str) -> None:
    """A row names the commit it was measured on, or is marked as not measured on this version."""
    table = rows(SECTIONS[heading])
    assert table
    assert not [row for row in table if bool(row["commit"]) is (OPEN in row.values())]
