"""A server whose robot is the rover."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from patience import patient
from rover import PREPARED
from serving import TOKEN, served

from kg.robot.connecting import SCHEMES

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from browsing import Chromium


@pytest.fixture(scope="session", autouse=True)
def _rover() -> Iterator[None]:
    """Register addresses of rovers in this process."""
    SCHEMES["rover"] = "rover"
    yield
    del SCHEMES["rover"]


@pytest.fixture(scope="session")
def robot_site(browser: Chromium, store: Path) -> Iterator[str]:  # noqa: ARG001 - no server without a browser
    """The address of a server with a rover, which uses the token of the tests."""
    slowly = {"KG_WATCHDOG": str(patient(0.5))}  # on a busy machine a process can wait that long for its turn
    with served(store, before=PREPARED, environment=slowly, log="off", token=TOKEN, robot="rover://one") as server:
        yield server.address
