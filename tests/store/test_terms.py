from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode, Quad, RdfFormat, Store, Triple, parse

from kg.store import bulk
from kg.store.terms import cells, of_spelling, parts_of_lines, spell, split_blank

P = NamedNode("urn:p")
G = NamedNode("urn:g")
XSD = "http://www.w3.org/2001/XMLSchema#"

numbers = st.sampled_from(["1", "+1", "-1", "01", "-0", "1.0", ".5", "0.10", "1e0", "INF", "true", "false", "x", " 1"])
types = st.sampled_from([NamedNode(XSD + name) for name in ("integer", "decimal", "double", "boolean", "date", "int")])
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)
plain = st.one_of(
    st.builds(Literal, texts),
    st.builds(lambda text: Literal(text, language="EN"), texts),
    st.builds(lambda text, datatype: Literal(text, datatype=datatype), numbers | texts, types),
    st.builds(lambda number: BlankNode(f"b{number}"), st.integers(0, 9)),
    st.sampled_from([NamedNode("urn:o"), NamedNode("http://example.org/é?q=1#)")]),
)
triples = st.builds(lambda term: Triple(P, P, term), plain)
terms = st.one_of(plain, triples, st.builds(lambda term: Triple(P, P, term), triples))


@given(st.lists(terms, max_size=8))
def test_cells_are_spelt_as_a_dump_of_the_store_spells_them(objects: list[Literal]) -> None:
    """Numbers, booleans, control characters and triple terms have the same spelling in a table and in N-Triples."""
    store = Store()
    store.bulk_extend(Quad(NamedNode(f"urn:s{number}"), P, term, G) for number, term in enumerate(objects))
    table = cells(bulk.table(lambda: store, "SELECT ?s ?o { ?s <urn:p> ?o }", G), 2)
    dump = store.dump(format=RdfFormat.N_TRIPLES, from_graph=G) or b""
    expected = {tuple(line[:-2].split(b" <urn:p> ", 1)) for line in dump.splitlines()}
    assert set(zip(table[0::2], table[1::2], strict=True)) == expected


def test_a_text_without_rows_has_no_cells() -> None:
    """An empty text gives no cells."""
    assert cells(b"", 2) == []


def test_each_column_may_hold_short_forms() -> None:
    """Every column is corrected independently of the others."""
    assert cells(b"1\t<urn:a>\n<urn:b>\ttrue\n", 2) == [
        b'"1"^^<http://www.w3.org/2001/XMLSchema#integer>',
        b"<urn:a>",
        b"<urn:b>",
        b'"true"^^<http://www.w3.org/2001/XMLSchema#boolean>',
    ]


@pytest.mark.parametrize(
    ("text", "datatype", "spelt"),
    [
        ("1", "nonNegativeInteger", b'"1"^^<%sinteger>'),
        ("01", "integer", b'"1"^^<%sinteger>'),
        ("1.50", "decimal", b'"1.5"^^<%sdecimal>'),
        ("1", "boolean", b'"true"^^<%sboolean>'),
        ("one", "integer", b'"one"^^<%sinteger>'),
    ],
)
def test_constants_are_spelt_as_a_store_gives_them_back(text: str, datatype: str, spelt: bytes) -> None:
    """A store keeps values: a constant of a rule with another spelling still matches its data."""
    assert spell(Literal(text, datatype=NamedNode(XSD + datatype))) == spelt % XSD.encode()


@given(st.lists(terms, max_size=8), st.booleans())
def test_lines_are_cut_into_terms_that_a_store_has(objects: list[Literal], padded: bool) -> None:  # noqa: FBT001 - drawn
    """Terms of a text are those of a store after loading it, whether the text is split or parsed."""
    lines = b"".join(b"<urn:s%d> <urn:p> %s .\n" % (number, written(term)) for number, term in enumerate(objects))
    found = parts_of_lines(lines + (b"# end\n" if padded else b""))
    store = Store()
    store.bulk_extend(parse(lines, RdfFormat.N_TRIPLES))
    stored = {(spell(quad.subject), spell(quad.predicate), spell(quad.object)) for quad in store}
    assert found is None or set(zip(found[0::3], found[1::3], found[2::3], strict=True)) == stored


@pytest.mark.parametrize("text", ["", "<urn:a> <urn:b>", "<urn:a> . <urn:b> <urn:c> <urn:d>", "a", '"a', "<a b>"])
def test_text_that_is_not_one_term_is_refused(text: str) -> None:
    """A term is parsed from exactly one term."""
    with pytest.raises(SyntaxError):
        of_spelling(text)


@given(terms)
def test_terms_are_read_back(term: Literal) -> None:
    """A spelling parses as the term in the store."""
    assert spell(of_spelling(spell(term))) == spell(term)


def written(term: Literal | Triple) -> bytes:
    """Return a term as N-Triples, with its original value."""
    if isinstance(term, Triple):
        return b"<<( <urn:p> <urn:p> %s )>>" % written(term.object)  # type: ignore[arg-type]  # what `terms` has inside
    return str(term).encode()


@given(
    st.lists(st.sampled_from([b"<urn:s> <urn:p> _:b .\n", b"_:b <urn:p> <urn:o> .\n", b"<urn:s> <urn:p> <urn:o> .\n"]))
)
def test_lines_with_blank_nodes_are_set_apart(lines: list[bytes]) -> None:
    """Both parts keep the order of their lines."""
    plain = [line for line in lines if b"_:" not in line]
    others = [line for line in lines if b"_:" in line]
    assert split_blank(b"".join(lines)) == (b"".join(plain), b"".join(others))
