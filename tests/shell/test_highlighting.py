from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kg.shell.editor import CLASSES, line_spans, spans
from kg.syntax.lexer import normalise

_TEXTS = st.lists(
    st.sampled_from(
        ["SELECT ", "?x ", "<urn:a> ", "# a\n", '"""a\nb""" ', "'it' ", "5 ", "a:b ", "{", "}", "\n", "é", "<"]
    )
).map("".join)


def test_every_kind_of_token_has_its_class() -> None:
    """Keywords, variables, names, strings, numbers and comments are distinguished; punctuation is plain."""
    text = 'SELECT ?x { ?x a:b <urn:c>, "d", 5 } # e'
    found = [(text[span.start : span.end], span.kind) for span in spans(text)]
    assert found == [
        ("SELECT", "keyword"),
        ("?x", "variable"),
        ("?x", "variable"),
        ("a:b", "name"),
        ("<urn:c>", "iri"),
        ('"d"', "string"),
        ("5", "number"),
        ("# e", "comment"),
    ]


def test_a_string_of_several_lines_has_a_part_in_each() -> None:
    """A long string is coloured on all of its lines."""
    found = line_spans('SELECT """a\nbc""" ?x')
    assert [(span.start, span.end, span.kind) for span in found[0]] == [(0, 6, "keyword"), (7, 11, "string")]
    assert [(span.start, span.end, span.kind) for span in found[1]] == [(0, 5, "string"), (6, 8, "variable")]


@given(_TEXTS | st.text())
def test_spans_stand_in_their_lines(text: str) -> None:
    """For any text, spans are ordered and none extends beyond its line."""
    text = normalise(text)
    lines = text.split("\n")
    for number, found in line_spans(text).items():
        ends = [0]
        for span in found:
            assert ends[-1] <= span.start <= span.end <= len(lines[number])
            assert span.kind in CLASSES
            ends.append(span.end)
