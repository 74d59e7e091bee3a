from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from lint.robot import write

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="session")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with launch files in `rover` and a store with findings about them, both read-only."""
    folder = tmp_path_factory.mktemp("robot")
    write(folder)
    return folder
