"""`kg build --store ADDRESS` builds as usual, and then replaces the changed graphs of a server."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from store.servers import oxigraph_server

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from cli.program import Program, Run

MANIFEST = """<package format="2"><name>talk</name><version>1.0.0</version><description>Talks.</description>
<maintainer email="a@example.org">A</maintainer><license>MIT</license><depend>rospy</depend></package>
"""
SCRIPT = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("talker")
rospy.Publisher("{topic}", String, queue_size=1)
"""


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    """The address of an Oxigraph server."""
    with oxigraph_server() as found:
        yield found


@pytest.fixture
def build(kg: Program, server: str) -> Callable[..., Run]:
    """Return a function that builds a package with a publisher to the server, by default with its update address."""

    def run(topic: str, addresses: tuple[str, ...] = ()) -> Run:
        folder = kg.folder / "ws" / "talk"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "package.xml").write_text(MANIFEST)
        (folder / "talker.py").write_text(SCRIPT.format(topic=topic))
        (folder / "talker.py").chmod(0o755)
        named = addresses or ("--store", f"{server}/query", "--update-url", f"{server}/update")
        return kg("build", "--no-rules", *named, "ws", XDG_CACHE_HOME=str(kg.folder / "cache"))

    return run


def _digest(kg: Program, store: str, folder: str) -> str:
    found = re.search(r"with digest (\w+)", kg("publish", "--no-index", "--store", store, folder).err)
    assert found
    return found[1]


def _mirror(folder: Path) -> str:
    (found,) = (folder / "cache" / "kg" / "servers").iterdir()
    return str(found)


def test_the_server_has_what_was_built(kg: Program, server: str, build: Callable[..., Run]) -> None:
    """Digests are equal after the first build, and after one that changes a graph."""
    wrote = []
    for number, topic in enumerate(["chatter", "chatter", "news"]):
        run = build(topic)
        assert run.code == 0, run.err
        wrote.append(int(re.findall(r"wrote (\d+) graph", run.err)[0]))
        assert _digest(kg, f"{server}/query", f"a{number}") == _digest(kg, _mirror(kg.folder), f"b{number}")
    assert wrote[1] == 0
    assert 0 < wrote[2] < wrote[0]
    assert "news" in kg("node", "talker", "--store", f"{server}/query").out


def test_an_address_for_queries_alone_is_named(server: str, build: Callable[..., Run]) -> None:
    """The hint names the missing option."""
    run = build("rumours", ("--store", f"{server}/query"))
    assert run.code == 4
    assert "--update-url" in run.err


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
