from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from workspaces import example

from kg import settings
from kg.store.opening import existing

if TYPE_CHECKING:
    from pathlib import Path

    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore


@dataclass(frozen=True, slots=True)
class Field:
    """A copy of the example workspace, in `field`, and its store."""

    source: Path
    settings: Settings

    @property
    def store(self) -> EmbeddedStore:
        """The store."""
        return existing(self.settings)


@pytest.fixture(scope="session", name="field")
def built(tmp_path_factory: pytest.TempPathFactory) -> Field:
    """Return the example workspace and its store, both read-only."""
    root = example(tmp_path_factory, "field")
    return Field(root / "field", settings.load({"store": root / ".kg"}))
