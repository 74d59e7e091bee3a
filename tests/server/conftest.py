"""The stores and the browser of the server's tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from browsing import chromium
from serving import TOKEN, application, served
from w3c import put
from w3c_http import Endpoint, Standard
from workspaces import example

from kg.store.layout import create

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from browsing import Chromium
    from starlette.testclient import TestClient


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example workspace as a store: its folder, which is read-only."""
    return example(tmp_path_factory) / ".kg"


@pytest.fixture(scope="session")
def client(store: Path) -> Iterator[TestClient]:
    """A client of a server with default options: read-only, on this machine."""
    with application(store, log="off") as found:
        yield found


@pytest.fixture(scope="session")
def browser() -> Iterator[Chromium]:
    """A headless Chromium."""
    with chromium() as found:
        yield found


@pytest.fixture(scope="session")
def standard(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Standard]:
    """A writable server with the data set of the standard; tests of W3C give it the data of each case."""
    layout = create(tmp_path_factory.mktemp("w3c") / ".kg")
    put(layout)
    with served(layout.root, write=True, token=TOKEN, no_union=True, log="off") as server:
        yield Standard(Endpoint("127.0.0.1", server.port, headers={"Authorization": f"Bearer {TOKEN}"}), layout)
