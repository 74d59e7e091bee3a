from __future__ import annotations

from datetime import UTC, datetime

from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import Literal, RdfFormat, parse

from kg.graph.ntriples import Writer, boolean, integer, literal, moment

SUBJECT = "<http://example.org/s>"
XSD = "http://www.w3.org/2001/XMLSchema#"


def read(term: str) -> Literal:
    """Return the literal that a parser of N-Triples reads from its spelling."""
    writer = Writer()
    writer.add(SUBJECT, SUBJECT, term)
    (quad,) = parse(writer.encoded(), format=RdfFormat.N_TRIPLES)
    assert isinstance(quad.object, Literal)
    return quad.object


@given(st.text() | st.text(st.sampled_from('"\\\n\r\t\0\x0b\x7f\x85\u2028\ufeff\U0001f916a')))
def test_any_text_is_read_back_as_it_was(text: str) -> None:
    """A parser reads exactly the written text, and every literal is on one line."""
    assert read(literal(text)).value == text
    assert not {"\n", "\r"} & set(literal(text))


@given(st.text(st.characters(codec=None)))
def test_what_is_no_unicode_is_replaced(text: str) -> None:
    """Lone surrogates, as in names of files that are not UTF-8, become U+FFFD."""
    assert read(literal(text)).value == "".join("\ufffd" if "\ud800" <= c <= "\udfff" else c for c in text)


@given(st.integers())
def test_numbers_keep_their_value(number: int) -> None:
    """Integers are `xsd:integer`, of any size."""
    term = read(integer(number))
    assert (int(term.value), term.datatype.value) == (number, f"{XSD}integer")


def test_other_types() -> None:
    """Booleans and times have the data types of XML Schema."""
    assert str(read(boolean(value=True))) == f'"true"^^<{XSD}boolean>'
    assert str(read(boolean(value=False))) == f'"false"^^<{XSD}boolean>'
    assert str(read(moment(datetime(2026, 1, 2, tzinfo=UTC)))) == f'"2026-01-02T00:00:00.000+00:00"^^<{XSD}dateTime>'


def test_shared_things_are_described_once() -> None:
    """`described` and `once` write on the first call only."""
    writer = Writer()
    assert writer.described(SUBJECT, "s", SUBJECT)
    assert not writer.described(SUBJECT, "s", SUBJECT)
    writer.once(SUBJECT, SUBJECT, literal("x"))
    writer.once(SUBJECT, SUBJECT, literal("x"))
    assert len(writer.lines) == 3


def test_nothing_is_written_for_what_is_not_known() -> None:
    """None gives no triple."""
    writer = Writer()
    writer.text(SUBJECT, SUBJECT, None)
    writer.number(SUBJECT, SUBJECT, None)
    assert writer.encoded() == b""
