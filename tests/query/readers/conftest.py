"""Stores for the tests of readers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from forks import READERS, fork_readers
from pyoxigraph import NamedNode

from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from kg.store.layout import Layout

EX = "https://example.org/"


def things(count: int) -> bytes:
    """Return a ring of `count` things, each with a number and a label."""
    lines = []
    for number in range(count):
        one, following = f"<{EX}{number}>", f"<{EX}{(number + 1) % count}>"
        lines += [
            f"{one} <{EX}p> {following} .",
            f"{one} <{EX}q> {following} .",
            f'{one} <{EX}number> "{number}"^^<http://www.w3.org/2001/XMLSchema#integer> .',
            f'{one} <{EX}label> "thing {number}"@en .',
        ]
    return "\n".join(lines).encode() + b"\n"


@pytest.fixture
def forked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork the parents of readers, which start for a quarter of a second; they are no children of this process."""
    monkeypatch.setattr(f"{READERS}.subprocess", fork_readers())


@pytest.fixture(scope="session")
def layout(tmp_path_factory: pytest.TempPathFactory) -> Layout:
    """A store with a thousand triples in the graph `g`, and one in `h`."""
    store = EmbeddedStore.create(tmp_path_factory.mktemp("readers") / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs(
            {
                NamedNode(EX + "g"): [things(250)],
                NamedNode(EX + "h"): [f'<{EX}h> <{EX}only> "in h" .\n'.encode()],
            }
        )
    return store.layout


@pytest.fixture
def fresh(tmp_path_factory: pytest.TempPathFactory) -> EmbeddedStore:
    """A small writable store for one test."""
    store = EmbeddedStore.create(tmp_path_factory.mktemp("fresh") / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({NamedNode(EX + "g"): [things(3)]})
    return store
