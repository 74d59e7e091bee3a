"""Queries and updates that are nearly right: put together from the grammar of SPARQL, and broken now and then."""

from __future__ import annotations

from typing import Final

from hypothesis import strategies as st

__all__ = ["queries", "updates"]

_PREFIX: Final = "PREFIX kg: <https://w3id.org/rnkg/ns#> PREFIX xsd: <http://www.w3.org/2001/XMLSchema#> "
_VARIABLES: Final = st.sampled_from(["?a", "?b", "?c", "$d", "?ä", "?SERVICE"])
_IRIS: Final = st.sampled_from(
    ["kg:Node", "kg:name", "kg:publishes", "<a:b>", "<>", "<#x>", "a", "<http://[>", "kg:x\\-y", "_:b", "[]", "kg:"]
)
_LITERALS: Final = st.sampled_from(
    ["1", "-1.5e300", "1e999", "true", "'x'", '"""\n"""', "'x'@en", "'x'@en--ltr", "'1'^^xsd:integer", "'x'^^xsd:date",
     "'9999999999999999999999'^^xsd:integer", "'\\ud800'", "'\\u0000'", "99999999999999999999", "<<( <a:a> <a:b> 1 )>>"]
)  # fmt: skip
_TERMS: Final = _VARIABLES | _IRIS | _LITERALS
_PATHS: Final = st.recursive(
    st.sampled_from(["kg:name", "a", "^kg:publishes", "!kg:name", "!(kg:name|^a)", "?p"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("*+?")).map("({0[0]}){0[1]}".format),
        st.tuples(inner, st.sampled_from("/|"), inner).map("({0[0]}){0[1]}({0[2]})".format),
    ),
    max_leaves=4,
)
_FUNCTIONS: Final = st.sampled_from(
    ["STR", "LANG", "BOUND", "ABS", "STRLEN", "REGEX", "REPLACE", "SUBSTR", "COALESCE", "IF", "xsd:dateTime", "COUNT",
     "UUID", "RAND", "NOW", "BNODE", "IRI", "SHA512", "STRDT", "STRLANG", "TRIPLE", "<a:unheard-of>", "GROUP_CONCAT"]
)  # fmt: skip
_EXPRESSIONS: Final = st.recursive(
    _TERMS,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "/", "*", "=", "<", "&&", "||", "IN", "-"]), inner).map(
            "({0[0]} {0[1]} {0[2]})".format
        ),
        st.tuples(_FUNCTIONS, st.lists(inner, max_size=4)).map(lambda pair: f"{pair[0]}({', '.join(pair[1])})"),
        inner.map("!({})".format),
        inner.map("EXISTS {{ ?a ?b {} }}".format),
    ),
    max_leaves=6,
)
_TRIPLES: Final = st.tuples(_TERMS, _PATHS, _TERMS).map("{0[0]} {0[1]} {0[2]} .".format)
_GROUPS: Final = st.recursive(
    _TRIPLES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4).map(" ".join),
        inner.map("OPTIONAL {{ {} }}".format),
        inner.map("{{ {0} }} UNION {{ {0} }}".format),
        inner.map("MINUS {{ {} }}".format),
        inner.map("GRAPH ?g {{ {} }}".format),
        inner.map("{{ SELECT * {{ {} }} LIMIT 3 }}".format),
        _EXPRESSIONS.map("FILTER({})".format),
        _EXPRESSIONS.map("BIND({} AS ?new)".format),
        st.lists(_TERMS, max_size=3).map(lambda terms: f"VALUES ?a {{ {' '.join(terms)} }}"),
        inner.map("SERVICE SILENT <http://127.0.0.1:9/> {{ {} }}".format),
        inner.map("LATERAL {{ {} }}".format),
    ),
    max_leaves=6,
)
_MODIFIERS: Final = st.lists(
    st.one_of(
        st.sampled_from(["LIMIT 10", "OFFSET 5", "LIMIT 0", "LIMIT 99999999999999999999", "REDUCED", "HAVING(?a>1)"]),
        _EXPRESSIONS.map("ORDER BY DESC({})".format),
        _EXPRESSIONS.map("GROUP BY {}".format),
    ),
    max_size=3,
).map(" ".join)
_HEADS: Final = st.one_of(
    st.sampled_from(["SELECT *", "SELECT DISTINCT ?a ?b", "ASK", "DESCRIBE ?a", "CONSTRUCT { ?a ?b ?c }", "SELECT"]),
    _EXPRESSIONS.map("SELECT ({} AS ?x)".format),
)
_DATASETS: Final = st.sampled_from(["", "", "", "FROM <a:g>", "FROM NAMED <a:g>", "FROM <a:g> FROM NAMED <a:h>"])
_WHOLE: Final = st.tuples(_HEADS, _DATASETS, _GROUPS, _MODIFIERS).map(
    lambda parts: f"{_PREFIX}{parts[0]} {parts[1]} WHERE {{ {parts[2]} }} {parts[3]}"
)
_OPERATIONS: Final = st.one_of(
    st.tuples(_TERMS, _TERMS).map("INSERT DATA {{ <a:f> {0[0]} {0[1]} }}".format),
    _TRIPLES.map("DELETE WHERE {{ GRAPH <a:f> {{ {} }} }}".format),
    _GROUPS.map("INSERT {{ GRAPH <a:f> {{ ?a <a:b> ?c }} }} WHERE {{ {} }}".format),
    st.sampled_from(
        ["CLEAR GRAPH <a:f>", "DROP SILENT GRAPH <a:f>", "LOAD <a:x>", "CREATE GRAPH <a:n>", "MOVE <a:f> TO <a:h>"]
    ),
)


@st.composite
def _broken(draw: st.DrawFn, texts: st.SearchStrategy[str]) -> str:
    """Return a text with a piece of it left out, doubled, or something odd put in."""
    text = draw(texts)
    where = draw(st.integers(0, len(text)))
    length = draw(st.integers(0, 8))
    odd = draw(
        st.sampled_from(["", "{", "}}", "'", '"""', "\x00", "\ufeff", "\u202e", "#", "\\u0041", "<", "((((", "%s"])
    )
    return text[:where] + odd + text[where + length :]


def queries() -> st.SearchStrategy[str]:
    """Return queries, most of which parse."""
    return st.one_of(_WHOLE, _WHOLE, _broken(_WHOLE), st.text(max_size=60))


def updates() -> st.SearchStrategy[str]:
    """Return updates, most of which parse."""
    whole = st.lists(_OPERATIONS, min_size=1, max_size=3).map(lambda parts: _PREFIX + " ; ".join(parts))
    return st.one_of(whole, whole, _broken(whole))
