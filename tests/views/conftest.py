"""The example workspace, built once for the tests of views."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from workspaces import example

from kg.settings import load
from kg.store.opening import reading

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


@pytest.fixture(scope="session")
def settings(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """The settings of a store with the example workspace, which is read-only."""
    return load({"store": str(example(tmp_path_factory) / ".kg")}, environment={})


@pytest.fixture(scope="session")
def snapshot(settings: Settings) -> Iterator[EmbeddedSnapshot]:
    """A snapshot of that store."""
    with reading(settings) as found:
        yield found
