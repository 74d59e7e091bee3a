"""The store of the shell's tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from workspaces import example

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example workspace as a store: its folder, which is read-only."""
    return example(tmp_path_factory) / ".kg"
