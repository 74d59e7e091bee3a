"""Rules give the same result everywhere: over files, in a store at once or after changes, on a server."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from pyoxigraph import NamedNode, RdfFormat
from store.servers import append, oxigraph_server

from kg.pipeline.inferring import run_on_files, run_on_server, run_on_store
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.remote import RemoteStore

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kg.settings import Settings

GRAPH, INFERRED = NamedNode("urn:test:g"), NamedNode("https://w3id.org/rnkg/graph/inferred")
DATA = """
<urn:test:a> <urn:test:p> <urn:test:b> .
<urn:test:a> <urn:test:n> "01"^^<http://www.w3.org/2001/XMLSchema#integer> .
<urn:test:b> <urn:test:n> "1"^^<http://www.w3.org/2001/XMLSchema#byte> .
<urn:test:c> <urn:test:n> "1.0"^^<http://www.w3.org/2001/XMLSchema#decimal> .
<urn:test:a> <urn:test:l> "x"@EN .
<urn:test:b> <urn:test:l> "x"@en .
"""
BODIES = {
    # A constant has a path of length zero to itself, even if no graph contains it (SPARQL 1.1, 18.4).
    ":absent :p* ?v . BIND(:absent AS ?a)": "absent absent",
    "?a :p* :absent . BIND(:absent AS ?v)": "absent absent",
    ":a :p* ?v . BIND(:a AS ?a)": "a a, a b",
    # A variable at both ends of a path is a node of the graph, even if bound elsewhere.
    "VALUES ?a { :lost :b } ?a :p* ?v": "b b",
    "BIND(:lost AS ?a) ?a :p? ?v": "",
    # Literals join if they are equal in a store, which stores values.
    "?a :n ?n . ?v :n ?n": "a a, a b, b a, b b, c c",
    '?a :n "+1"^^xsd:integer . ?v :p ?a': "b a",
    "?a :l ?n . ?v :l ?n": "a a, a b, b a, b b",
}
EXPECTED = {
    (f"<urn:test:h{number}>", f"<urn:test:{pair.split()[0]}>", f"<urn:test:{pair.split()[1]}>")
    for number, pairs in enumerate(BODIES.values())
    for pair in filter(None, pairs.split(", "))
}


def over_files(settings: Settings, folder: Path) -> bytes:
    """Return the inferences from a file."""
    (folder / "in.nt").write_text(DATA)
    run_on_files(settings, [folder / "in.nt"], folder / "out.nt")
    return (folder / "out.nt").read_bytes()


def in_a_store(settings: Settings, folder: Path) -> bytes:
    """Return the inferences in a store that is filled at once."""
    return _in_a_store(settings, folder, [DATA])


def after_changes(settings: Settings, folder: Path) -> bytes:
    """Return the inferences in a store that receives one triple after the other."""
    return _in_a_store(settings, folder, DATA.splitlines(keepends=True)[1:])


def _in_a_store(settings: Settings, folder: Path, parts: list[str]) -> bytes:
    store = EmbeddedStore.create(folder / ".kg")
    for part in parts:
        with store.write("test") as transaction:
            transaction.append(GRAPH, part.encode())
        run_on_store(settings)
    with store.read() as snapshot:
        return snapshot.dump(RdfFormat.N_TRIPLES, graph=INFERRED)


def on_a_server(settings: Settings, _folder: Path) -> bytes:
    """Return the inferences on a server."""
    with oxigraph_server() as address:
        remote = RemoteStore(f"{address}/query", f"{address}/update")
        append(remote, GRAPH, DATA.encode())
        run_on_server(settings, f"{address}/query", f"{address}/update")
        return remote.read().dump(RdfFormat.N_TRIPLES, graph=INFERRED)


@pytest.mark.parametrize("run", [over_files, in_a_store, after_changes, on_a_server])
def test_rules_mean_the_same_everywhere(tmp_path: Path, run: Callable[[Settings, Path], bytes]) -> None:
    """Paths of length zero and values of literals give the same triples everywhere."""
    (tmp_path / "rules" / "mine").mkdir(parents=True)
    prefixes = "PREFIX : <urn:test:> PREFIX xsd: <http://www.w3.org/2001/XMLSchema#> "
    for number, body in enumerate(BODIES):
        text = f"{prefixes}CONSTRUCT {{ ?a :h{number} ?v }} WHERE {{ {body} }}"
        (tmp_path / "rules" / "mine" / f"r{number}.rq").write_text(text)
    given: dict[str, Any] = {"rules": str(tmp_path / "rules"), "rule_families": "mine", "store": str(tmp_path)}
    lines = run(load(given, environment={}, folder=tmp_path), tmp_path).decode().splitlines()
    assert {(words[1], words[0], words[2]) for words in (line.split() for line in lines)} == EXPECTED
