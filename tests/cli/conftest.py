from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from cli.program import Program

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def kg(tmp_path: Path) -> Program:
    """Return the program in an empty folder."""
    return Program(tmp_path)
