"""C1 and C2: the protocol and the graph store protocol of SPARQL 1.1, by the W3C cases over a port."""

from __future__ import annotations

import shutil
import socket
import subprocess
import sysconfig
import time
from contextlib import nullcontext
from typing import TYPE_CHECKING, Final

import pytest
from patience import patient
from ports import own_port
from w3c import Case, parameters, path_of, put
from w3c_http import Endpoint, play, prepare

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from w3c_http import Standard

NO_FORMS: Final = "answered 415"
NO_TYPE: Final = "content-type: \\)"
NOT_BY_OXIGRAPH: Final = {
    "post_get_post_get_direct": NO_FORMS,
    "post_get_post_get_indirect": NO_FORMS,
    "head_existing_direct": NO_TYPE,
    "head_existing_indirect": NO_TYPE,
}
"""The cases that Oxigraph's server fails: it lacks multipart/form-data, and HEAD has no type."""

protocol = pytest.mark.parametrize("case", parameters("protocol/manifest.ttl", "ProtocolTest"))
graph_store = pytest.mark.parametrize("case", parameters("graph-store-protocol/manifest.ttl", "GraphStoreProtocolTest"))


@protocol
def test_protocol(case: Case, standard: Standard) -> None:
    """A query or an update is answered as the protocol specifies."""
    put(standard.layout, named=prepare(case))
    play(case, standard.endpoint)


@graph_store
def test_graph_store(case: Case, standard: Standard) -> None:
    """A graph is read and written as the graph store protocol specifies."""
    put(standard.layout)
    play(case, standard.endpoint)


@pytest.fixture(scope="module")
def oxigraph(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Endpoint]:
    """Oxigraph's own server, whose results with these cases are known."""
    # pip installs it next to the interpreter, which need not be on the path.
    program = shutil.which("oxigraph", path=sysconfig.get_path("scripts")) or shutil.which("oxigraph")
    if program is None:
        pytest.skip("oxigraph is not installed (`pip install oxigraph`)")
    folder: Path = tmp_path_factory.mktemp("oxigraph")
    with own_port() as port:
        command = [program, "serve", "--location", str(folder), "--bind", f"127.0.0.1:{port}"]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            _wait_for(port)
            yield Endpoint("127.0.0.1", port, query="/query")
            process.kill()


def _wait_for(port: int) -> None:
    end = time.monotonic() + patient(30)
    while time.monotonic() < end:
        try:
            with socket.create_connection(("127.0.0.1", port), timeout=1):
                return
        except OSError:
            time.sleep(0.05)
    pytest.fail("oxigraph does not listen")


@protocol
def test_oxigraph_protocol(case: Case, oxigraph: Endpoint) -> None:
    """Oxigraph's server passes all protocol cases, which validates the test driver."""
    oxigraph.send("POST", "/update", b"DROP ALL", content_type="application/sparql-update")
    for name, file in prepare(case).items():
        content = path_of(file).read_bytes()
        oxigraph.send("PUT", f"/store?graph={name}", content, content_type="application/n-triples")
    play(case, oxigraph)


@graph_store
def test_oxigraph_graph_store(case: Case, oxigraph: Endpoint) -> None:
    """Oxigraph's server passes all cases of the graph store protocol except its known failures."""
    oxigraph.send("POST", "/update", b"DROP ALL", content_type="application/sparql-update")
    failure = NOT_BY_OXIGRAPH.get(case.identity.rpartition("#")[2])
    with pytest.raises(AssertionError, match=failure) if failure else nullcontext():
        play(case, oxigraph)
