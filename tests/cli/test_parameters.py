"""Values of `--param`: texts, and terms in Turtle."""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

import pytest
from cli.program import Program

if TYPE_CHECKING:
    from pathlib import Path

DATA = """
@prefix : <https://example.org/> . @prefix ros: <http://data.mksmart.org/onto-ros/class#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
:s :iri ros:Node ; :text "ros:Node" ; :number 42 ; :digits "42" ; :decimal 0.5 ; :yes true ; :word "true" ;
   :tagged "Haus"@de ; :day "2026-01-01"^^xsd:date .
"""
QUERY = "PREFIX : <https://example.org/> SELECT ?p { :s ?p ?o }"


@pytest.fixture(scope="module")
def kg(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """Return the program in a folder with a store of values, which the tests only read."""
    found = Program(tmp_path_factory.mktemp("values"))
    (found.folder / "values.ttl").write_text(DATA)
    found("import", "values.ttl", "--no-rules")
    return found


@pytest.mark.parametrize(
    ("given", "property_"),
    [
        ("o=ros:Node", "text"),
        ("o:=ros:Node", "iri"),
        ("o:=<http://data.mksmart.org/onto-ros/class#Node>", "iri"),
        ('o:="ros:Node"', "text"),
        ("o=42", "digits"),
        ("o:=42", "number"),
        ("o:=0.5", "decimal"),
        ("o=true", "word"),
        ("o:=true", "yes"),
        ("?o:='Haus'@de", "tagged"),
        ('o:="2026-01-01"^^xsd:date', "day"),
        ("p:=:day", "day"),
    ],
)
def test_a_value_is_a_text_and_a_term_is_marked(kg: Program, given: str, property_: str) -> None:
    """`NAME=VALUE` sets a text, whatever it looks like; `NAME:=TERM` a term, also with the prefixes of the query."""
    run = kg("query", QUERY, "--param", given, "--format", "tsv")
    assert (run.code, run.out.splitlines()[1:]) == (0, [f"<https://example.org/{property_}>"])


@pytest.mark.parametrize(
    "given", ["o:=a b", "o:=_:x", "o:=<relative>", "o:=1, 2", "o:=1 . <a:b> <a:b> 2", "o:=", "o:=no:x"]
)
def test_what_is_not_one_term_is_refused(kg: Program, given: str) -> None:
    """A malformed term is KG505; nothing else than one IRI or literal gets into the query."""
    run = kg("query", QUERY, "--param", given)
    assert (run.code, "KG505" in run.err) == (5, True)


def test_a_query_in_a_file_has_a_mark_or_another_encoding(kg: Program, tmp_path: Path) -> None:
    """A byte order mark is skipped; what is not UTF-8 is an error with the byte."""
    (tmp_path / "marked.rq").write_bytes(b"\xef\xbb\xbfASK {}")
    (tmp_path / "latin.rq").write_bytes(b"ASK { <urn:a> <urn:b> '\xe4' }")
    assert kg("query", "-f", str(tmp_path / "marked.rq")).out.strip() == "true"
    run = kg("query", "-f", str(tmp_path / "latin.rq"))
    assert (run.code, "not in UTF-8 at byte 23" in run.err) == (2, True)


def test_an_export_is_compressed(kg: Program, tmp_path: Path) -> None:
    """The ending `.gz` compresses the format before it, and the file reads back."""
    exported = tmp_path / "all.ttl.gz"
    assert kg("export", "-o", str(exported)).code == 0
    assert gzip.decompress(exported.read_bytes()).startswith(b"@prefix")
    assert kg("--store", str(tmp_path / "other"), "import", str(exported), "--no-rules").code == 0


def test_a_name_has_one_value(kg: Program) -> None:
    """A repeated name is an error, as one of its values would be ignored."""
    run = kg("query", QUERY, "--param", "o=1", "--param", "?o:=2")
    assert (run.code, "given twice" in run.err) == (2, True)


@pytest.mark.parametrize(
    ("given", "written"), [("o=rdf:type", "o:=rdf:type"), ("o=https://example.org/x", "o:='<https://example.org/x>'")]
)
def test_a_term_that_was_meant_is_suggested(kg: Program, given: str, written: str) -> None:
    """If a text finds nothing and is also a term, a note shows how to write the term."""
    run = kg("query", QUERY, "--param", given)
    assert (run.code, written in run.err) == (0, True)
