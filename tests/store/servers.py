"""SPARQL servers for tests: Oxigraph on a free port of this machine, and Virtuoso."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from patience import patient
from ports import own_port

from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pyoxigraph import NamedNode

    from kg.store.remote import RemoteStore

__all__ = ["append", "load_server", "oxigraph_server", "virtuoso_server"]

BATCH = 500

VIRTUOSO = """
[Parameters]
ServerPort = {sql}
NumberOfBuffers = 10000
MaxDirtyBuffers = 6000
ServerThreads = 10
[HTTPServer]
ServerPort = {http}
ServerRoot = .
ServerThreads = 5
"""


@contextmanager
def oxigraph_server() -> Iterator[str]:
    """Run `oxigraph serve` in memory and yield its address; skip the test if it is not installed."""
    # pip installs it next to the Python that runs the tests, which need not be on the path.
    program = shutil.which("oxigraph", path=str(Path(sys.executable).parent)) or shutil.which("oxigraph")
    if program is None:
        pytest.skip("oxigraph is not installed (pip install oxigraph)")
    with own_port() as port:
        address = f"127.0.0.1:{port}"
        command = [program, "serve", "--bind", address]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            _wait(f"http://{address}/")
            yield f"http://{address}"
        finally:
            process.terminate()
            process.wait()


@contextmanager
def virtuoso_server(folder: Path) -> Iterator[str]:
    """Run Virtuoso in a folder and yield the address of its SPARQL endpoint, with public updates.

    Skip the test if the programs of Debian's package are not installed.
    """
    programs = [shutil.which(name) for name in ("virtuoso-t", "isql-vt")]
    if None in programs:
        pytest.skip("Virtuoso is not installed (apt-get install virtuoso-opensource-7-bin)")
    with own_port() as sql, own_port() as http:
        (folder / "virtuoso.ini").write_text(VIRTUOSO.format(sql=sql, http=http))
        command = [str(programs[0]), "+configfile", "virtuoso.ini", "+foreground"]
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            address = f"http://127.0.0.1:{http}/sparql"
            _wait(f"{address}?query=ASK%7B%7D", 60)
            grant = 'GRANT SPARQL_UPDATE TO "SPARQL";'
            admin = [str(programs[1]), f"127.0.0.1:{sql}", "dba", "dba", f"exec={grant}"]
            subprocess.run(admin, check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
            yield address
        finally:
            process.terminate()
            process.wait()


def append(remote: RemoteStore, graph: NamedNode, triples: bytes) -> None:
    """Add N-Triples to a graph of a server."""
    remote.update(f"INSERT DATA {{ GRAPH {graph} {{\n{triples.decode()}}} }}")


def load_server(store: Path, remote: RemoteStore) -> None:
    """Send all quads of a store's folder to a server, in small requests."""
    with EmbeddedStore.create(store).read() as snapshot:
        for graph in snapshot.graphs():
            lines = snapshot.content(graph).decode().splitlines()
            plain = [line for line in lines if "_:" not in line]
            for start in range(0, len(plain), BATCH):
                remote.update(f"INSERT DATA {{ GRAPH {graph} {{\n" + "\n".join(plain[start : start + BATCH]) + "\n} }")
            # Together, so that a label is one node; Virtuoso allows blank nodes in a template only.
            if blank := [line for line in lines if "_:" in line]:
                remote.update(f"INSERT {{ GRAPH {graph} {{\n" + "\n".join(blank) + "\n} } WHERE { }")


def _wait(address: str, seconds: float = 10) -> None:
    end = time.monotonic() + patient(seconds)
    while time.monotonic() < end:
        try:
            with urllib.request.urlopen(address, timeout=patient(5)):  # noqa: S310 - a server of the test
                return
        except OSError:
            time.sleep(0.05)
    pytest.fail(f"{address} did not start")
