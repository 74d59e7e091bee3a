"""Reading commands give the same results over a SPARQL server as over the store with the same graph."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import pytest
from cli.program import Program
from serving import served
from store.servers import load_server, oxigraph_server, virtuoso_server
from workspaces import example

from kg.store.remote import RemoteStore

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from cli.program import Run

READING = [
    ["nodes"],
    ["nodes", "--json"],
    ["node", "patrol", "--all", "--via"],
    ["node", "patrol", "--json"],
    ["node", "/patrol"],
    ["topic", "/cmd_vel"],
    ["query", "SELECT ?node ?topic { ?node rnkg:publishes/rdfs:label ?topic } ORDER BY ?node ?topic"],
    ["query", "SELECT (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } FILTER(STRSTARTS(STR(?g), 'https://w3id.org/rnkg/')) }"],
    ["query", "who-publishes", "--param", "topic=cmd_vel"],
    ["query", "ASK { ?node a ros:Node }"],
    ["query", "CONSTRUCT { ?node a ros:Node } { ?node a ros:Node }", "--format", "ntriples"],
    ["why", "patrol", "subscribes", "scan_filtered"],
    ["why", "patrol", "subscribes", "cmd_vel"],
    ["lint"],
    ["search", "laser", "scan", "--json"],
    ["topics"],
    ["services"],
    ["actions", "--json"],
    ["packages"],
    ["service", "set_gripper"],
    ["action", "move_arm"],
    ["param", "max_speed"],
    ["stats"],
    ["instances"],
    ["instances", "rover.launch", "--json"],
    ["graph", "rover.launch", "--dot"],
    ["impact", "/cmd_vel"],
    ["why-not", "patrol", "subscribes", "topic/cmd_vel"],
    ["compose", "--from", "LaserScan", "--to", "PointCloud2", "--json"],
]


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of the example workspace."""
    return example(tmp_path_factory)


@pytest.fixture(scope="module", params=["kg", "oxigraph", pytest.param("virtuoso", marks=pytest.mark.virtuoso)])
def server(request: pytest.FixtureRequest, store: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The query address of a server with the same graph."""
    if request.param == "kg":
        with served(store) as serving:
            yield f"{serving.address}/sparql"
    elif request.param == "oxigraph":
        with oxigraph_server() as found:
            load_server(store / ".kg", RemoteStore(f"{found}/query", f"{found}/update"))
            yield f"{found}/query"
    else:
        with virtuoso_server(tmp_path_factory.mktemp("virtuoso")) as found:
            load_server(store / ".kg", RemoteStore(found))
            yield found


@pytest.fixture(scope="module")
def of_store(store: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Run]:
    """Return the result of a command over the store, run once for all servers; source files have absolute paths."""
    program = Program(tmp_path_factory.mktemp("elsewhere"))
    return cache(lambda *command: program("--store", str(store), *command))


@pytest.mark.parametrize("command", READING, ids=" ".join)
def test_answers_are_those_of_the_store(
    request: pytest.FixtureRequest, kg: Program, of_store: Callable[..., Run], server: str, command: list[str]
) -> None:
    """Output, up to the order of the rows of queries, and exit code are equal."""
    if command == ["stats"] and "virtuoso" in request.node.name:
        pytest.skip("Virtuoso 7 fails at the nested queries of `kg stats`, with an internal error that is shown")
    here, there = of_store(*command), kg("--store", server, *command)
    # Virtuoso sorts texts in an order of its own.
    ordered = sorted if command[0] == "query" else list
    assert (there.code, ordered(there.out.splitlines())) == (here.code, ordered(here.out.splitlines())), there.err


@pytest.mark.parametrize(
    "command",
    [
        ["status"],
        ["update", "CLEAR ALL"],
        ["backup", "x"],
        ["rules", "run"],
    ],
    ids=" ".join,
)
def test_other_commands_are_refused(kg: Program, command: list[str]) -> None:
    """A command that a server cannot answer is KG309, with instructions, before any request."""
    run = kg("--store", "http://127.0.0.1:9/sparql", *command)
    assert run.code == 4
    assert "error[KG309]: the command does not work on a SPARQL server" in run.err


def test_credentials_do_not_belong_into_the_address(kg: Program) -> None:
    """Credentials in the address are rejected, and not repeated."""
    run = kg("--store", "https://me:secret@example.org/sparql", "nodes")
    assert "error[KG225]: credentials do not belong on the command line" in run.err
    assert "secret" not in run.err


def test_a_server_that_is_not_there_is_named(kg: Program) -> None:
    """An unreachable server is KG225 with the address."""
    run = kg("--store", "http://127.0.0.1:9/sparql", "nodes")
    assert run.code == 4
    assert "error[KG225]" in run.err


def test_a_file_of_settings_names_no_server(kg: Program) -> None:
    """A kg.toml of a checkout cannot make `kg` connect to a server, or send it credentials."""
    (kg.folder / "kg.toml").write_text('store = "http://127.0.0.1:9/sparql"\n')
    run = kg("nodes")
    assert run.code == 2
    assert "error[KG002]: kg.toml cannot name a server as the store" in run.err
