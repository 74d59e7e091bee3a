"""`kg build --store ADDRESS` and `kg import` work as usual, and then replace the changed graphs of a server."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from cli.program import Program
from store.servers import oxigraph_server, virtuoso_server

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from cli.program import Run

MANIFEST = """<package format="2"><name>talk</name><version>1.0.0</version><description>Talks.</description>
<maintainer email="a@example.org">A</maintainer><license>MIT</license><depend>rospy</depend></package>
"""
SCRIPT = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("talker")
rospy.Publisher("{topic}", String, queue_size=1)
"""


FILE = """@prefix e: <https://example.org/> .
e:rover e:part [ e:name "arm" ; e:length 1.50 ; e:tested true ] .
"""


@dataclass(frozen=True)
class Server:
    """Addresses of a server, and the environment with a login for updates."""

    query: str
    update: str
    login: dict[str, str]

    @property
    def options(self) -> tuple[str, ...]:
        """The options of commands that write."""
        return "--store", self.query, "--update-url", self.update


@pytest.fixture(scope="module", params=["oxigraph", pytest.param("virtuoso", marks=pytest.mark.virtuoso)])
def server(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """An Oxigraph server, and a Virtuoso server whose address for updates requires Digest authentication."""
    if request.param == "oxigraph":
        with oxigraph_server() as found:
            yield Server(f"{found}/query", f"{found}/update", {})
    else:
        with virtuoso_server(tmp_path_factory.mktemp("virtuoso")) as found:
            yield Server(found, f"{found}-auth", {"KG_REMOTE_USER": "dba", "KG_REMOTE_PASSWORD": "dba"})


def _build(kg: Program, server: Server, topic: str, addresses: tuple[str, ...] = (), **environment: str) -> Run:
    """Build a package with a publisher to the server, by default with its update address."""
    folder = kg.folder / "ws" / "talk"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(MANIFEST)
    (folder / "talker.py").write_text(SCRIPT.format(topic=topic))
    (folder / "talker.py").chmod(0o755)
    used = {**_environment(kg, server), **environment}
    return kg("build", "--no-rules", *(addresses or server.options), "ws", folder=kg.folder, **used)


@pytest.fixture(scope="module")
def first(server: Server, tmp_path_factory: pytest.TempPathFactory) -> tuple[Program, Run]:
    """A folder whose package was built to the server, and the result."""
    kg = Program(tmp_path_factory.mktemp("first"))
    return kg, _build(kg, server, "chatter")


def _environment(kg: Program, server: Server) -> dict[str, str]:
    return {"XDG_CACHE_HOME": str(kg.folder / "cache"), **server.login}


def _digest(kg: Program, store: str, folder: str) -> str:
    found = re.search(r"with digest (\w+)", kg("publish", "--no-index", "--store", store, folder).err)
    assert found
    return found[1]


def _mirror(folder: Path) -> str:
    (found,) = (folder / "cache" / "kg" / "servers").iterdir()
    return str(found)


def test_the_server_has_what_was_built(server: Server, first: tuple[Program, Run]) -> None:
    """Digests are equal after the first build, and after one that changes a graph; without a change, none is sent."""
    kg, run = first
    wrote = []
    for number, topic in enumerate(("chatter", "chatter", "news")):
        if number:
            run = _build(kg, server, topic)
        assert run.code == 0, run.err
        wrote.append(int(re.findall(r"wrote (\d+) graph", run.err)[0]))
        if wrote[-1]:
            assert _digest(kg, server.query, f"a{number}") == _digest(kg, _mirror(kg.folder), f"b{number}")
    assert wrote[1] == 0
    assert 0 < wrote[2] < wrote[0]
    assert "news" in kg("node", "talker", "--store", server.query).out


def test_the_server_has_what_was_imported(server: Server, first: tuple[Program, Run]) -> None:
    """Blank nodes and values are those of the file; a file that was imported before is replaced by its new content."""
    kg, _ = first
    for text in (FILE, FILE.replace("arm", "leg")):
        (kg.folder / "rover.ttl").write_text(text)
        run = kg("import", "rover.ttl", "--no-rules", *server.options, folder=kg.folder, **_environment(kg, server))
        assert run.code == 0, run.err
        assert "wrote 2 graphs" in run.err
    assert _digest(kg, server.query, "a") == _digest(kg, _mirror(kg.folder), "b")
    rows = kg("query", "SELECT ?name { ?x <https://example.org/name> ?name }", "--store", server.query).out
    assert "arm" in rows
    assert "leg" in rows


def test_an_address_for_queries_alone_is_named(kg: Program, server: Server) -> None:
    """The hint names the missing option."""
    if server.login:
        pytest.skip("Virtuoso accepts updates at its address for queries")
    run = _build(kg, server, "rumours", ("--store", server.query))
    assert run.code == 4
    assert "--update-url" in run.err


def test_a_wrong_password_is_reported(kg: Program, server: Server) -> None:
    """The hint names the variables, and the password is not shown."""
    if not server.login:
        pytest.skip("Oxigraph requires no login")
    run = _build(kg, server, "rumours", KG_REMOTE_PASSWORD="secret")  # noqa: S106 - a wrong one
    assert run.code == 4
    assert "the server answered 401" in run.err
    assert "KG_REMOTE_PASSWORD" in run.err
    assert "secret" not in run.err


def test_an_address_for_updates_needs_a_server(kg: Program) -> None:
    """KG003, because a store in a folder would ignore it."""
    run = kg("build", "--update-url", "http://127.0.0.1:9/", ".")
    assert run.code == 2
    assert "error[KG003]: --update-url needs a server" in run.err


def test_credentials_do_not_belong_into_either_address(kg: Program) -> None:
    """Neither is sent or shown."""
    addresses = ["--store", "http://127.0.0.1:9/query", "--update-url", "http://me:secret@127.0.0.1:9/update"]
    run = kg("build", *addresses, ".")
    assert "error[KG225]: credentials do not belong on the command line" in run.err
    assert "secret" not in run.err
