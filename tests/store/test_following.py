"""Only real changes of a server's data are detected."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from ports import own_port
from store.servers import oxigraph_server

from kg.errors import StoreError
from kg.store.following import Following
from kg.store.layout import Layout
from kg.store.remote import RemoteStore

if TYPE_CHECKING:
    from pathlib import Path


def test_a_change_has_another_number(tmp_path: Path) -> None:
    """The number changes only with the sizes of graphs, or the end of the last run of rules."""
    with oxigraph_server() as address:
        remote = RemoteStore(f"{address}/query", f"{address}/update")
        layout = Layout(tmp_path, f"{address}/query")
        following = Following(layout)
        numbers = []
        first = "{ GRAPH <urn:g> { <urn:a> <http://www.w3.org/ns/prov#endedAtTime> '2026-01-01' } }"
        for update in (
            "",
            f"INSERT DATA {first}",
            "",
            f"DELETE DATA {first} ; INSERT DATA {first.replace('-01', '-02')}",
        ):
            if update:
                remote.update(update)
            following.look()
            numbers.append(layout.current())
        assert numbers == [1, 2, 2, 3]


def test_a_server_that_does_not_answer_keeps_its_number(tmp_path: Path) -> None:
    """The failure is recorded, and raised when a response is needed."""
    with own_port() as port:
        layout = Layout(tmp_path, f"http://127.0.0.1:{port}/query", silence=1)
        following = Following(layout)
        following.look()
        assert layout.current() == 1
        assert following.failure is not None
        with pytest.raises(StoreError, match="cannot connect"):
            following.check()
