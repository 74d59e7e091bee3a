"""A small store for the tests of queries."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode
from workspaces import example

from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.store.snapshot import EmbeddedSnapshot

DATA = b"""
<https://example.org/a> <https://w3id.org/rnkg/ns#name> "a" .
<https://example.org/b> <https://w3id.org/rnkg/ns#name> "b|c" .
<https://example.org/a> <https://example.org/size> "3"^^<http://www.w3.org/2001/XMLSchema#integer> .
<https://example.org/a> <https://example.org/label> "eins,\\"zwei\\"\\r\\ndrei\\tvier"@de .
<https://example.org/a> <https://example.org/knows> _:x .
<https://example.org/a> <https://example.org/flag> "true"^^<http://www.w3.org/2001/XMLSchema#boolean> .
"""


@pytest.fixture(scope="session")
def snapshot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmbeddedSnapshot]:
    """A store with six triples, one of them in two graphs."""
    root = tmp_path_factory.mktemp("query")
    store = EmbeddedStore.create(root / ".kg")
    with store.write("test") as transaction:
        first = DATA.splitlines(keepends=True)[1]
        transaction.replace_graphs(
            {NamedNode("https://example.org/g"): [DATA], NamedNode("https://example.org/h"): [first]}
        )
    with store.read() as opened:
        yield opened


@pytest.fixture(scope="session")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmbeddedSnapshot]:
    """The example workspace, and the odd packages of `cases/odd`, in one store."""
    root = example(tmp_path_factory, more=[Path(__file__).parent / "cases" / "odd"])
    with EmbeddedStore(Layout(root / ".kg")).read() as opened:
        yield opened
