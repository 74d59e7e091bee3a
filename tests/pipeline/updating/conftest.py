"""A store with a few rules of its own, for each test."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pipeline.updating.changing import Bench, bench

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def own(tmp_path: Path) -> Bench:
    """An empty store whose rules infer reachability along `:next`."""
    return bench(tmp_path)
