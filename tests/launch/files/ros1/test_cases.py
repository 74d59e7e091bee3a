"""Cases are files: `cases/CASE/PACKAGE/...` are launch trees, `expected.json` describes the system of `launch`.

`about` is the rule under test; `given` and `environment` are set by the caller.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from files.ros1.records import CASES, case_workspace, configuration, record

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.parent.name)
def test_case(case: Path, tmp_path: Path) -> None:
    """A launch tree gives the expected nodes, parameters and problems with their lines."""
    expected = json.loads(case.read_text(encoding="utf-8"))
    workspace = case_workspace(tmp_path, case.parent)
    given, environment = expected.get("given", {}), expected.get("environment", {})
    found = record(configuration(workspace, expected["launch"], given, environment))
    assert found == expected["expect"]
