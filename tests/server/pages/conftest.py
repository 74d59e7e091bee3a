"""One server for all tests of pages."""

from __future__ import annotations

from typing import TYPE_CHECKING

import httpx
import pytest
from listing import Shown, shown
from patience import patient
from serving import served

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from browsing import Chromium


@pytest.fixture(scope="session")
def site(browser: Chromium, store: Path) -> Iterator[str]:  # noqa: ARG001 - no server without a browser
    """The address of a server of the example workspace."""
    with served(store, log="off") as server:
        yield server.address


@pytest.fixture(scope="session")
def things(site: str) -> Shown:
    """The entities of the example workspace shown by the pages."""
    with httpx.Client(base_url=site, timeout=patient(30)) as client:
        return shown(client)
