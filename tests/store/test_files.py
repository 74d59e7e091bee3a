"""RDF files as users have them: compressed, with a byte order mark, or damaged."""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import RdfFormat

from kg.errors import GraphError
from kg.store.embedded import EmbeddedStore
from kg.store.files import format_of, quads_of

if TYPE_CHECKING:
    from pathlib import Path

TURTLE = b"@prefix : <https://example.org/> .\n:s :p :o .\n"
HEAD = b'<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">\n<rdf:Description rdf:about="urn:a">\n'
DAMAGED = {
    "an element without a namespace": (HEAD + b"<bad/>\n</rdf:Description></rdf:RDF>", "a.rdf", 3, "namespaces"),
    "an element closed by another": (HEAD + b"<rdf:value>\nx</rdf:valu>", "a.rdf", 4, "</rdf:value>"),
    "a relative IRI in a later line": (HEAD + b'</rdf:Description>\n\n<rdf:Seq rdf:about="a b"/>', "a.rdf", 5, "IRI"),
    "a document that is cut off": (HEAD + b"<rdf:value>x</rdf:value>\n", "a.owl", 4, "ends too early"),
    "a document without elements": (b"", "a.rdf", 1, "ends too early"),
    "a term that does not parse": (TURTLE + b":s :p .\n", "a.ttl", 3, "not a valid RDF object"),
    "a file that is not compressed": (TURTLE, "a.ttl.gz", None, "cannot be unpacked"),
    "a compressed file that is cut off": (
        gzip.compress(TURTLE * 9, mtime=0)[:-9],
        "a.ttl.gz",
        None,
        "cannot be unpacked",
    ),
}


@pytest.mark.parametrize(
    "content",
    [b"\xef\xbb\xbf" + TURTLE, gzip.compress(TURTLE), gzip.compress(b"\xef\xbb\xbf" + TURTLE)],
    ids=["mark", "compressed", "both"],
)
def test_a_mark_and_compression_are_no_content(tmp_path: Path, content: bytes) -> None:
    """A byte order mark is skipped and a file that ends in `.gz` unpacked, by every way to read a file."""
    path = tmp_path / ("a.ttl.gz" if content.startswith(b"\x1f\x8b") else "a.ttl")
    path.write_bytes(content)
    (quad,) = quads_of(path, format_of(path) or RdfFormat.N_QUADS)
    with EmbeddedStore.create(tmp_path / ".kg").write("test") as transaction:
        transaction.load_file(path)
        assert transaction.query(f"ASK {{ {quad.triple} }}")


@pytest.mark.parametrize("case", DAMAGED)
def test_damage_has_its_line(tmp_path: Path, case: str) -> None:
    """What does not parse is KG601 with the line and without that of the engine; nothing is loaded."""
    content, name, line, words = DAMAGED[case]
    path = tmp_path / name
    path.write_bytes(content)
    store = EmbeddedStore.create(tmp_path / ".kg")
    with pytest.raises(GraphError) as caught, store.write("test") as transaction:
        transaction.load_file(path)
    assert (caught.value.code, caught.value.place and caught.value.place.line) == ("KG601", line)
    assert words in caught.value.message
    assert "line" not in caught.value.message
    assert store.layout.current() is None


def test_an_unknown_ending_names_no_format(tmp_path: Path) -> None:
    """The format is that of the ending before `.gz`; other endings have none."""
    assert [format_of(tmp_path / name) for name in ("a.nq.gz", "A.TTL", "a.owl", "a.gz", "a", "a.csv")] == [
        RdfFormat.N_QUADS,
        RdfFormat.TURTLE,
        RdfFormat.RDF_XML,
        None,
        None,
        None,
    ]
