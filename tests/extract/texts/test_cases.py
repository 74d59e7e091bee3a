"""Descriptions are cases: `cases/<case>/` has packages and `expected.json`, their expected descriptions.

`expected.json` has for each package all descriptions as `[kind, path:line, node, heading, text]`, in the order of their
places.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.extract.package import extract_package
from kg.facts import Repository

CASES = sorted(path.parent for path in (Path(__file__).parent / "cases").glob("*/expected.json"))


def described(case: Path) -> dict[str, list[list[str | None]]]:
    """Return the descriptions of all packages of a case in the form of its file."""
    workspace = Workspace([scan(case, Repository(f"local/{case.name}", str(case)))])
    found = {}
    for source in workspace.sources:
        for package in source.packages:
            facts = extract_package(Reader(workspace, source, package))
            found[package.name] = [
                [str(one.kind), f"{one.location.path}:{one.location.line}", one.node, one.heading, one.text]
                for one in facts.descriptions
            ]
    return found


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case(case: Path) -> None:
    """The descriptions of a case are exactly the expected ones, each at its line."""
    assert described(case) == json.loads((case / "expected.json").read_text())


def test_pages_around_a_package_are_inputs() -> None:
    """A README of the repository is an input of the package it was read for, so its changes are detected."""
    case = Path(__file__).parent / "cases" / "readme"
    source = scan(case, Repository("local/readme", str(case)))
    facts = extract_package(Reader(Workspace([source]), source, source.packages[0]))
    assert {"local/readme:README.md", "local/readme:doc/arm/index.rst"} <= dict(facts.inputs).keys()


def test_cases_are_found() -> None:
    """The runner finds the cases, so none of them passes without running."""
    assert {case.name for case in CASES} >= {
        "cpp-comments",
        "python-docstrings",
        "readme",
        "plugins-and-launch",
        "wiki",
    }
