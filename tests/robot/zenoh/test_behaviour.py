"""A connection over Zenoh passes the suite of every connection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from robot.connections import Behaviour, System, types_for_tests

pytest.importorskip("zenoh", reason="the extra `zenoh` is not installed")

from robot.zenoh.hub import hub

from kg.robot.connecting import connect

if TYPE_CHECKING:
    from collections.abc import Iterator


class TestZenoh(Behaviour):
    """The suite of every connection."""

    @pytest.fixture
    def system(self) -> Iterator[System]:
        """Yield a peer that all nodes connect to."""
        with hub() as (place, _):
            address = f"zenoh://{place}?settle=1"
            yield System(
                2, lambda name: connect(address, name=name, types=types_for_tests(2)), seconds=5, confirms=False
            )
