from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.query.completion.site import Form, typed

PIECES = [
    "SELECT",
    "?x",
    "rnkg:a",
    '"',
    "'",
    '"""',
    "<",
    "<urn:a>",
    "#",
    "\n",
    "\r\n",
    "{",
    "}",
    "\\",
    "\U0001f600",
    " ",
    "é",
    ".",
]


@pytest.mark.parametrize(
    ("marked", "form", "word", "replaced"),
    [
        ("|", Form.NOTHING, "", ""),
        ("SEL|", Form.WORD, "SEL", "SEL"),
        ("SEL|ECT", Form.WORD, "SEL", "SELECT"),
        ("SELECT |", Form.NOTHING, "", ""),
        ("SELECT ?|", Form.VARIABLE, "?", "?"),
        ("SELECT ?no|de ?x", Form.VARIABLE, "?no", "?node"),
        ("ASK { ?x rnkg:pub|lishes ?y", Form.NAME, "rnkg:pub", "rnkg:publishes"),
        ("ASK { ?x rnkg:|", Form.NAME, "rnkg:", "rnkg:"),
        ("ASK { ?x rnkg:a?|", Form.NOTHING, "", ""),
        ('ASK { ?x ?p "sc|', Form.STRING, "sc", '"sc'),
        ('ASK { ?x ?p "sc|an" }', Form.STRING, "sc", '"scan"'),
        ('ASK { ?x ?p "sc| }', Form.STRING, "sc", '"sc'),
        ("ASK { ?x ?p 'a b|", Form.STRING, "a b", "'a b"),
        ("ASK { ?x ?p <http|://a> }", Form.IRI, "<http", "<http://a>"),
        ("ASK { ?x ?p ?o # ?x|", Form.COMMENT, "", ""),
        ("ASK { FILTER(?a <|", Form.NOTHING, "", ""),
        ('ASK { ?x ?p "\U0001f600" ; rd|', Form.WORD, "rd", "rd"),
    ],
)
def test_what_is_being_typed(marked: str, form: Form, word: str, replaced: str) -> None:
    """The word at the cursor is found, including the part after it, also in strings, IRIs and comments."""
    position = marked.index("|")
    text = marked.replace("|", "", 1)
    found = typed(text, position)
    assert (found.form, found.text if form is not Form.COMMENT else "", text[found.start : found.end]) == (
        form,
        word,
        replaced,
    )


@given(st.lists(st.sampled_from(PIECES)).map("".join), st.integers(-2, 80))
def test_the_range_lies_around_the_cursor(text: str, position: int) -> None:
    """The replaced range begins at or before the cursor, ends at or after it, and is within the text."""
    found = typed(text, position)
    assert 0 <= found.start <= max(0, min(position, len(text))) <= found.end <= len(text)
    assert all(token.end <= found.start for token in found.before)
    assert all(token.start >= found.end for token in found.after)
