"""A small store for the tests of queries."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode

from kg.pipeline.build import build
from kg.resources import folder
from kg.settings import load
from kg.store.embedded import EmbeddedStore

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
    root = tmp_path_factory.mktemp("examples")
    # Outside of any checkout, so the names of the sources do not depend on the location of the tests.
    shutil.copytree(folder("examples") / "workspace", root / "examples")
    shutil.copytree(Path(__file__).parent / "cases" / "odd", root / "odd")
    store = EmbeddedStore.create(root / ".kg")
    build([str(root / "examples"), str(root / "odd")], store, load({}, environment={}))
    with store.read() as opened:
        yield opened
