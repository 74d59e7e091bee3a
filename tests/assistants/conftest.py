"""The example workspace in a store, and a client of the SDK connected to a server of it."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from forks import READERS, fork_readers
from workspaces import example

from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from contextlib import AbstractAsyncContextManager
    from pathlib import Path


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a store of the example workspace."""
    return example(tmp_path_factory) / ".kg"


@pytest.fixture(autouse=True)
def _forked_readers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork the readers of each server from a process that has imported what they need."""
    monkeypatch.setattr(f"{READERS}.subprocess", fork_readers())


@pytest.fixture
def connected(store: Path) -> Callable[..., AbstractAsyncContextManager[Any]]:
    """Return a function that opens a client of a server in this process; it takes settings and client options."""
    mcp = pytest.importorskip("mcp", reason="the extra `mcp` is not installed")
    from kg.assistants.server import create_server  # noqa: PLC0415 - needs the SDK

    @asynccontextmanager
    async def open_client(settings: dict[str, Any] | None = None, **options: Any) -> AsyncIterator[Any]:
        async with mcp.Client(create_server(load({"store": store, **(settings or {})})), **options) as client:
            yield client

    return open_client
