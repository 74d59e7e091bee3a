"""Complete packages in `tests/extract/cases/build`: `expected.json` has the content of their build files."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Final

import pytest

from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.extract.manifests import read_build, read_manifest
from kg.facts import Location, Repository

CASES: Final = Path(__file__).resolve().parent.parent / "cases" / "build"


def plain(value: object) -> object:
    """Return facts as JSON, with places as `path:line`, and without empty fields."""
    if isinstance(value, dict):
        if value.keys() == {"path", "line", "repository"}:
            return str(Location(**value))
        return {key: plain(item) for key, item in value.items() if item not in (None, (), "", [])}
    return [plain(item) for item in value] if isinstance(value, list | tuple) else value


def read(case: Path) -> object:
    """Return the package, its build model and the problems of a case."""
    source = scan(case, Repository(f"local/{case.name}", str(case)))
    workspace = Workspace([source])
    reader = Reader(workspace, source, source.packages[0])
    package = read_manifest(reader, reader.package)
    model = read_build(reader, reader.package)
    problems = [asdict(problem) for problem in reader.problems]
    return plain({"package": asdict(package), "build": asdict(model), "problems": problems})


@pytest.mark.parametrize("case", sorted(path.name for path in CASES.iterdir()))
def test_case(case: str) -> None:
    """The content of a case's build files equals the expected one."""
    expected = json.loads((CASES / case / "expected.json").read_text())
    assert read(CASES / case) == expected
