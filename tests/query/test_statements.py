from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.query.statements import segment_at, statement_at, statements
from kg.syntax.lexer import normalise

_TWO = "# one\nSELECT * { ?s ?p ?o { SELECT ?s { } } }\nLIMIT 3\n\n# two\nPREFIX a: <urn:a>\nASK { a:b a:c 'ASK {' }\n"
_PARTS = st.lists(
    st.sampled_from(["SELECT ", "ASK ", "PREFIX a: <urn:a>\n", "{", "}", "(", ")", "?x ", "'ASK'", "#a\n"])
)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", []),
        ("# nothing", []),
        ("ASK {}", ["ASK {}"]),
        ("ASK {} ASK {}", ["ASK {}", "ASK {}"]),
        (_TWO, ["SELECT * { ?s ?p ?o { SELECT ?s { } } }\nLIMIT 3", "PREFIX a: <urn:a>\nASK { a:b a:c 'ASK {' }"]),
        ("BASE <urn:a> PREFIX a: <urn:b> DESCRIBE a:c", ["BASE <urn:a> PREFIX a: <urn:b> DESCRIBE a:c"]),
        ("CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }", ["CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }"]),
    ],
)
def test_queries_are_told_apart(text: str, found: list[str]) -> None:
    """A query ends where the prologue or the form of the next begins, outside of brackets, strings and comments."""
    assert [one.text for one in statements(text)] == found


@pytest.mark.parametrize(
    ("offset", "begin"), [(0, "SELECT"), (20, "SELECT"), (60, "SELECT"), (75, "PREFIX"), (999, "PREFIX")]
)
def test_the_query_at_the_cursor_is_found(offset: int, begin: str) -> None:
    """The query contains or precedes the cursor; before all of them it is the first."""
    found = statement_at(_TWO, offset)
    assert found is not None
    assert found.text.startswith(begin)


def test_a_segment_has_what_is_behind_its_query() -> None:
    """Whitespace after a query belongs to its segment, for completion there."""
    text = "ASK { ?s \nASK {} "
    assert segment_at(text, 8).text == "ASK { ?s \nASK {} "
    assert segment_at("ASK {} \nSELECT * { ?s ", 21) == ("SELECT * { ?s ", 8, 22)
    assert segment_at("", 0).text == ""


@given(_PARTS.map("".join) | st.text())
def test_queries_follow_each_other(text: str) -> None:
    """Queries are in the order of the text, and segments cover it."""
    text = normalise(text)
    end = 0
    for one in statements(text):
        assert end <= one.start < one.end <= len(text)
        assert text[one.start : one.end] == one.text
        end = one.end
    begin = 0
    while begin < len(text):
        part = segment_at(text, begin)
        assert part.start in {begin, 0}
        assert part.end > begin
        begin = part.end
