from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from workspaces import example

from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from kg.settings import Settings


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """The settings of a store that does not exist yet."""
    return load({"store": str(tmp_path / ".kg")}, environment={}, folder=tmp_path)


@pytest.fixture
def store(settings: Settings) -> EmbeddedStore:
    """An empty store."""
    assert isinstance(settings.store, Path)
    return EmbeddedStore.create(settings.store)


@pytest.fixture(scope="session")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a store of the example workspace, which tests copy."""
    return example(tmp_path_factory)


@pytest.fixture
def built(workspace: Path, tmp_path: Path) -> Settings:
    """The settings of the test's own copy of a store of the example workspace."""
    shutil.copytree(workspace / ".kg", tmp_path / "built")
    return load({"store": str(tmp_path / "built")}, environment={}, folder=tmp_path)
