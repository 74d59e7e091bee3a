"""The store of the shell's tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from forks import READERS, fork_readers
from textual import screen
from workspaces import example

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(autouse=True)
def _seldom_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw the screen ten times a second: with the 120 times of Textual, a third of the processor time is drawing."""
    monkeypatch.setattr(screen, "UPDATE_PERIOD", 0.1)


@pytest.fixture(autouse=True)
def _forked_readers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork the readers of each shell from a process that has imported what they need."""
    monkeypatch.setattr(f"{READERS}.subprocess", fork_readers())


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example workspace as a store: its folder, which is read-only."""
    return example(tmp_path_factory) / ".kg"
