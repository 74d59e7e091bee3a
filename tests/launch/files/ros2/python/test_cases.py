"""Cases are files: `cases/<case>/launch.py`, with its actions and problems in `expected.txt`.

Other files of a case are in the same package `demo`; those below `packages/` are separate packages, and `given.json`
has the arguments set by the caller. To see the current result, run this file with the name of a case.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from files.ros2.python.described import described, read_text

CASES = sorted(path.parent for path in (Path(__file__).parent / "cases").glob("*/launch.py"))


def read(case: Path, root: Path) -> str:
    """Return the result of a case."""
    files = {
        path.relative_to(case).as_posix().replace("packages/", "../", 1): path.read_bytes()
        for path in sorted(case.rglob("*"))
        if path.is_file() and path.name not in {"expected.txt", "given.json"}
    }
    given = case / "given.json"
    return described(*read_text(root, files, json.loads(given.read_text()) if given.exists() else None))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case(case: Path, tmp_path: Path) -> None:
    """A launch file gives the actions and problems expected by its case."""
    assert read(case, tmp_path) == (case / "expected.txt").read_text()


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        sys.stdout.write(read(Path(__file__).parent / "cases" / sys.argv[1], Path(folder)))
