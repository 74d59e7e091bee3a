"""`kg files`: the files of packages, classified as code and text."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import pytest
from cli.program import Program

from kg.errors import Exit
from kg.resources import folder

if TYPE_CHECKING:
    from typing import Any


@pytest.fixture(scope="module")
def rover(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """Return the program in a folder with a store of the example rover."""
    root = tmp_path_factory.mktemp("files")
    shutil.copytree(folder("examples") / "workspace" / "rover", root / "rover")
    program = Program(root)
    assert program("build", "rover").code == Exit.OK
    return program


def listed(rover: Program, *options: str) -> dict[str, dict[str, Any]]:
    """Return the listed files by path within the package."""
    rows = map(json.loads, rover("files", "--json", *options).out.splitlines())
    return {row["path"].partition("rover_robot/")[2]: row for row in rows if row["package"] == "rover_robot"}


def test_files_are_sorted_into_code_and_text(rover: Program) -> None:
    """Code with comments is both; manifests contain texts, and build files neither."""
    found = listed(rover)
    assert (found["src/scan_filter_nodelet.cpp"]["sort"], found["src/scan_filter_nodelet.cpp"]["nodes"]) == ("both", 1)
    assert found["launch/rover.launch"]["sort"] == "code"
    assert found["package.xml"]["sort"] == "text"
    assert found["CMakeLists.txt"]["sort"] == "other"


def test_a_sort_and_a_package_narrow_the_list(rover: Program) -> None:
    """Only files of the given kind and package are listed."""
    assert {row["sort"] for row in listed(rover, "--sort", "text").values()} == {"text"}
    assert not listed(rover, "--package", "rover_core")


@pytest.mark.parametrize(
    ("options", "part"),
    [(("--sort", "prose"), "code, both, text, other"), (("--package", "rover_robo"), "rover_robot")],
)
def test_unknown_names_are_told_with_those_that_are_known(rover: Program, options: tuple[str, str], part: str) -> None:
    """An unknown kind or package is an error with instructions."""
    run = rover("files", *options)
    assert run.code != Exit.OK
    assert part in run.err
