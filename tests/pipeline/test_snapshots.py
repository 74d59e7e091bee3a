"""A published snapshot is pulled unchanged; anything else leaves the store unchanged."""

from __future__ import annotations

import gzip
import hashlib
import json
import threading
from dataclasses import dataclass, field
from functools import partial
from http.server import BaseHTTPRequestHandler, SimpleHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

import pytest
from pyoxigraph import NamedNode

from kg.errors import KgError
from kg.pipeline.snapshots import publish, pull
from kg.store.backups import canonical
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

GRAPH = NamedNode("https://example.org/g")
ENOUGH = 1 << 20


@pytest.fixture
def store(tmp_path: Path) -> EmbeddedStore:
    """A store with a few quads, including a blank node."""
    made = EmbeddedStore.create(tmp_path / "origin")
    with made.write("test") as transaction:
        transaction.replace_graphs({GRAPH: [b"<urn:a> <urn:b> <urn:c> .\n_:x <urn:b> <urn:d> .\n"]})
    return made


@pytest.fixture
def published(store: EmbeddedStore, tmp_path: Path) -> Path:
    """A folder with this published store and a rule."""
    rules = tmp_path / "own" / "mine"
    rules.mkdir(parents=True)
    (rules / "rule.rq").write_text("CONSTRUCT {} WHERE {}")
    (rules / "notes.txt").write_text("no rule")
    with store.read() as snapshot:
        publish(snapshot, str(tmp_path / "published"), "https://example.org/", [tmp_path / "own"])
    return tmp_path / "published"


@pytest.fixture
def target(tmp_path: Path) -> EmbeddedStore:
    """An empty store."""
    return EmbeddedStore.create(tmp_path / "target")


def content(store: EmbeddedStore) -> list[bytes]:
    """Return the quads of a store."""
    with store.read() as snapshot:
        return canonical(snapshot.quads())


def changed(folder: Path, change: Callable[[dict[str, Any]], None]) -> None:
    """Change the manifest of a snapshot."""
    path = folder / "manifest.json"
    manifest = json.loads(path.read_bytes())
    change(manifest)
    path.write_text(json.dumps(manifest))


def refused(address: str | Path, store: EmbeddedStore, code: str, limit: int = ENOUGH) -> None:
    """Check that a snapshot is refused, and that the store remains empty, without other files."""
    with pytest.raises(KgError) as caught:
        pull(str(address), store, limit)
    assert caught.value.code == code
    assert store.layout.current() is None
    assert not list(store.layout.root.glob("pull-*"))


@dataclass
class Site:
    """A local web server with its uploaded files."""

    address: str
    received: dict[str, bytes] = field(default_factory=dict)
    credentials: list[str | None] = field(default_factory=list)


@pytest.fixture
def site(published: Path) -> Iterator[Site]:
    """A web server that serves the published folder and accepts PUT."""

    class Handler(SimpleHTTPRequestHandler):
        def do_PUT(self) -> None:
            found.received[self.path] = self.rfile.read(int(self.headers["Content-Length"]))
            found.credentials.append(self.headers["Authorization"])
            self.send_response(201)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            """Log nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=str(published)))
    found = Site(f"http://127.0.0.1:{server.server_port}")
    thread = threading.Thread(target=server.serve_forever, args=(0.01,))
    thread.start()
    yield found
    server.shutdown()
    thread.join()
    server.server_close()


def test_a_folder_is_pulled(store: EmbeddedStore, published: Path, target: EmbeddedStore) -> None:
    """Content, digest and rules arrive; no command searches for rules there."""
    manifest = pull(str(published), target, ENOUGH)
    assert content(target) == content(store)
    assert manifest.digest == hashlib.blake2b(b"".join(content(store)), digest_size=16).hexdigest()
    kept = target.layout.root / "published"
    assert [path.relative_to(kept).as_posix() for path in kept.rglob("*.*")] == ["manifest.json", "rules/mine/rule.rq"]


def test_a_web_server_is_pulled_from(store: EmbeddedStore, site: Site, target: EmbeddedStore) -> None:
    """The same over HTTP, with or without a trailing slash."""
    pull(f"{site.address}/", target, ENOUGH)
    assert content(target) == content(store)


def test_a_web_server_is_published_to(store: EmbeddedStore, site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    """All files are uploaded, the manifest last, with the credentials of the environment."""
    monkeypatch.setenv("KG_REMOTE_TOKEN", "secret")
    with store.read() as snapshot:
        manifest = publish(snapshot, f"{site.address}/robots", "https://example.org/")
    assert list(site.received) == [f"/robots/{manifest.graph.path}", "/robots/manifest.json"]
    assert set(site.credentials) == {"Bearer secret"}


def test_publishing_again_replaces(store: EmbeddedStore, published: Path, target: EmbeddedStore) -> None:
    """The earlier graph is deleted from the folder, and pulling again gets the new one."""
    pull(str(published), target, ENOUGH)
    with store.write("test") as transaction:
        transaction.append(GRAPH, b"<urn:a> <urn:b> <urn:new> .\n")
    with store.read() as snapshot:
        publish(snapshot, str(published), "https://example.org/")
    assert len(list(published.glob("graph-*"))) == 1
    assert not list(published.rglob("*.rq"))
    pull(str(published), target, ENOUGH)
    assert content(target) == content(store)
    assert not (target.layout.root / "published" / "rules").exists()


def test_a_folder_with_something_else_is_not_written_to(store: EmbeddedStore, tmp_path: Path) -> None:
    """KG566, and the files remain."""
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "thesis.tex").write_text("")
    with store.read() as snapshot, pytest.raises(KgError) as caught:
        publish(snapshot, str(tmp_path / "thesis"), "https://example.org/")
    assert caught.value.code == "KG566"
    assert [path.name for path in (tmp_path / "thesis").iterdir()] == ["thesis.tex"]


def test_a_store_that_was_built_is_not_replaced(store: EmbeddedStore, published: Path) -> None:
    """KG566 for a store whose content was not pulled."""
    before = content(store)
    with pytest.raises(KgError) as caught:
        pull(str(published), store, ENOUGH)
    assert caught.value.code == "KG566"
    assert content(store) == before


@pytest.mark.parametrize(
    "path",
    ["../escaped", "/escaped", "rules/../../escaped", "rules/.hidden", "rules//x.rq", "rules", "manifest.json", ""],
)
def test_no_path_leads_out_of_the_folder(published: Path, target: EmbeddedStore, path: str) -> None:
    """A manifest that names any other file is refused before fetching."""
    changed(published, lambda manifest: manifest["rules"][0].update(path=path))
    refused(published, target, "KG307")


def test_files_are_compared_with_their_digests(published: Path, target: EmbeddedStore) -> None:
    """A single different byte is detected, even if the graph can be unpacked."""
    (graph,) = published.glob("graph-*")
    graph.write_bytes(gzip.compress(gzip.decompress(graph.read_bytes()).replace(b"urn:a", b"urn:z"), mtime=0))
    changed(published, lambda manifest: manifest["graph"].update(bytes=graph.stat().st_size))
    refused(published, target, "KG307")


def test_a_bomb_is_not_unpacked(published: Path, target: EmbeddedStore) -> None:
    """A graph that unpacks to more than its size in the manifest is cut."""
    (graph,) = published.glob("graph-*")
    graph.write_bytes(gzip.compress(b"<urn:a> <urn:b> <urn:c> .\n" * 10_000))
    digest = hashlib.blake2b(graph.read_bytes(), digest_size=16).hexdigest()
    changed(published, lambda manifest: manifest["graph"].update(bytes=graph.stat().st_size, digest=digest))
    refused(published, target, "KG308")


def test_a_large_snapshot_is_refused(published: Path, target: EmbeddedStore) -> None:
    """The limit applies to the unpacked size."""
    refused(published, target, "KG308", limit=20)


def test_a_server_that_sends_without_end_is_cut(target: EmbeddedStore) -> None:
    """A manifest is only read up to a limit."""

    class Endless(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.end_headers()
            try:
                while True:
                    self.wfile.write(b" " * (1 << 16))
            except OSError:
                return

        def log_message(self, *_: object) -> None:
            """Log nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Endless)
    thread = threading.Thread(target=server.serve_forever, args=(0.01,))
    thread.start()
    try:
        refused(f"http://127.0.0.1:{server.server_port}", target, "KG308")
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"form": 1}', "\xff"])
def test_what_is_no_manifest_is_refused(published: Path, target: EmbeddedStore, text: str) -> None:
    """Other JSON, and invalid JSON, is KG307."""
    (published / "manifest.json").write_bytes(text.encode("latin-1"))
    refused(published, target, "KG307")


def test_a_graph_that_is_not_valid_is_refused(published: Path, target: EmbeddedStore) -> None:
    """A syntax error in a graph with correct digests is KG601, and creates no generation."""
    text = b"<urn:a> <urn:b> .\n"
    (graph,) = published.glob("graph-*")
    graph.write_bytes(gzip.compress(text))
    packed, unpacked = (hashlib.blake2b(one, digest_size=16).hexdigest() for one in (graph.read_bytes(), text))
    size = graph.stat().st_size
    changed(published, lambda manifest: manifest["graph"].update(bytes=size, digest=packed))
    changed(published, lambda manifest: manifest.update(unpacked=len(text), digest=unpacked))
    refused(published, target, "KG601")


@pytest.mark.parametrize(
    ("address", "code"),
    [
        ("ftp://example.org/x", "KG307"),
        ("http://user:secret@example.org/x", "KG225"),
        ("gone", "KG307"),
    ],
)
def test_addresses_that_are_refused(target: EmbeddedStore, address: str, code: str) -> None:
    """Other schemes, credentials on the command line, and missing folders are refused."""
    refused(address, target, code)


def test_credentials_are_not_sent_in_the_clear(target: EmbeddedStore, monkeypatch: pytest.MonkeyPatch) -> None:
    """A token in the environment is only sent to another machine over https."""
    monkeypatch.setenv("KG_REMOTE_TOKEN", "secret")
    refused("http://example.invalid/x", target, "KG225")
