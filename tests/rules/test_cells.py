from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode, Quad, RdfFormat, Store, Triple

from kg.rules.cells import cells
from kg.store import bulk

P = NamedNode("urn:p")
G = NamedNode("urn:g")
XSD = "http://www.w3.org/2001/XMLSchema#"

numbers = st.sampled_from(["1", "+1", "-1", "01", "-0", "1.0", ".5", "0.10", "1e0", "INF", "true", "false", "x", " 1"])
types = st.sampled_from([NamedNode(XSD + name) for name in ("integer", "decimal", "double", "boolean", "date", "int")])
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)
plain = st.one_of(
    st.builds(Literal, texts),
    st.builds(lambda text: Literal(text, language="en"), texts),
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
    """Nothing gives nothing."""
    assert cells(b"", 2) == []


def test_each_column_may_hold_short_forms() -> None:
    """Repair looks at every column, whatever stands in the others."""
    assert cells(b"1\t<urn:a>\n<urn:b>\ttrue\n", 2) == [
        b'"1"^^<http://www.w3.org/2001/XMLSchema#integer>',
        b"<urn:a>",
        b"<urn:b>",
        b'"true"^^<http://www.w3.org/2001/XMLSchema#boolean>',
    ]
