from __future__ import annotations

import shutil
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from repository import ROOT

from kg import settings
from kg.pipeline.build import build
from kg.store.opening import existing, writable

if TYPE_CHECKING:
    from pathlib import Path

    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore


@dataclass(frozen=True, slots=True)
class Field:
    """A copy of the example workspace, in `field`, and a store of it."""

    source: Path
    settings: Settings

    @property
    def store(self) -> EmbeddedStore:
        """The store."""
        return existing(self.settings)


@pytest.fixture(scope="session", name="field")
def built(tmp_path_factory: pytest.TempPathFactory) -> Field:
    """Return the example workspace and its store; tests change neither."""
    folder = tmp_path_factory.mktemp("evaluate")
    source = folder / "field"
    shutil.copytree(ROOT / "examples" / "workspace", source)
    given = settings.load({"store": folder / "store"})
    with writable(given) as target:
        build([str(source)], target, given, None, "test")
    return Field(source, given)
