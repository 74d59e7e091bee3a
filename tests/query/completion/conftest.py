"""Completing in the example workspace."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from kg.query.completion.keeping import Kept
from kg.query.completion.service import complete
from kg.query.stored import discover

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.store.snapshot import EmbeddedSnapshot


@pytest.fixture(scope="session")
def kept(examples: EmbeddedSnapshot) -> Kept:
    """What is kept of the example workspace, in this process alone."""
    return Kept(None, examples)


@pytest.fixture
def offered(kept: Kept) -> Callable[[str], list[dict[str, Any]]]:
    """Return what is offered where a query has its bar."""

    def ask(marked: str) -> list[dict[str, Any]]:
        position = marked.index("|")
        text = marked[:position] + marked[position + 1 :]
        found: list[dict[str, Any]] = complete(text, position, kept, lambda: list(discover().values()))["items"]
        return found

    return ask
