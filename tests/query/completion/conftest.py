"""Fixtures for completion in the example workspace."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from kg.query.completion.service import complete
from kg.query.completion.statistics import SnapshotCache
from kg.query.stored import discover

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.store.snapshot import EmbeddedSnapshot


@pytest.fixture(scope="session")
def kept(examples: EmbeddedSnapshot) -> SnapshotCache:
    """Statistics of the example workspace, cached in this process only."""
    return SnapshotCache(None, examples)


@pytest.fixture
def offered(kept: SnapshotCache) -> Callable[[str], list[dict[str, Any]]]:
    """Return a function for the completions at the bar in a query."""

    def ask(marked: str) -> list[dict[str, Any]]:
        position = marked.index("|")
        text = marked[:position] + marked[position + 1 :]
        found: list[dict[str, Any]] = complete(text, position, kept, lambda: list(discover().values()))["items"]
        return found

    return ask
