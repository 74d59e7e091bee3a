"""Every figure of docs/benchmarks.md is in the log, and those of the log have commands and commits that exist."""

from __future__ import annotations

import importlib
import re
import subprocess
from functools import cache
from itertools import pairwise
from typing import Final

import pytest
from repository import ROOT
from test_docs import COMMANDS

PAGE: Final = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
LOG: Final = (ROOT / "docs" / "benchmarks-log.md").read_text(encoding="utf-8")
OPEN: Final = "not measured on this version"


def sections(page: str, level: str = "##") -> dict[str, str]:
    """Return the text of each section by its heading."""
    headings = [*re.finditer(rf"^{level} (.*)\n", page, re.MULTILINE), re.search(r"\Z", page)]
    return {here[1]: page[here.end() : after.start()] for here, after in pairwise(headings) if here and after}


RESULTS: Final = sections(PAGE)
SECTIONS: Final = sections(LOG)


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
    """A commit named by a page is an ancestor of the current one."""
    named = set(re.findall(r"(?<![@\w])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*[0-9])[0-9a-f]{7,40}\b", PAGE + LOG))
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


def anchor(heading: str) -> str:
    """Return the address of a heading within its page."""
    return re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("heading", RESULTS)
def test_a_result_is_in_the_sections_of_the_log_that_its_section_links_to(heading: str) -> None:
    """Each row of the page in force names commits that the linked sections of the log name too."""
    section = RESULTS[heading]
    log = {anchor(name): text for level in ("##", "###") for name, text in sections(LOG, level).items()}
    linked = "".join(log[name] for name in re.findall(r"\(benchmarks-log\.md#([\w-]+)\)", section))
    table = rows(section)
    assert table
    assert not [row for row in table for commit in row["commit"].split(", ") if not commit or commit not in linked]


@pytest.mark.parametrize(("program", "table"), [("parts", "PARTS"), ("stages", "STAGES")])
def test_the_functions_that_a_build_is_measured_by_exist(
    monkeypatch: pytest.MonkeyPatch, program: str, table: str
) -> None:
    """Each stage of `benchmarks/build` begins with functions that are there under these names."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks" / "build")
    stages = getattr(importlib.import_module(program), table)
    assert not [(stage, name) for stage, begun in stages.items() for owner, name in begun if not hasattr(owner, name)]
