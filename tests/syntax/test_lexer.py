"""Tests of splitting queries into tokens."""

from __future__ import annotations

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.syntax.lexer import Kind, normalise, tokens

PIECES = st.lists(st.sampled_from([*list("<>'\"#(){}[]\\?$:.,;!|^&@=*/+-_ \n\tabz09é😀"), "'''", "<<", "a:b"]))


def kinds(text: str) -> list[tuple[str, str]]:
    """Return kind and text of each token."""
    return [(token.kind.name, token.text) for token in tokens(text)]


@given(PIECES.map("".join))
def test_nothing_is_lost(text: str) -> None:
    """Tokens are in order, equal their part of the text, and are separated only by whitespace and comments."""
    end = 0
    for token in tokens(text):
        assert token.start >= end
        assert text[token.start : token.end] == token.text != ""
        between = text[end : token.start].strip()
        assert between == "" or between.startswith("#") or "\n" in text[end : token.start]
        end = token.end


@given(st.text())
def test_any_text_is_split(text: str) -> None:
    """Any text can be split, and line ends become line feeds."""
    list(tokens(normalise(text)))
    assert "\r" not in normalise(text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("?a<?b", [("VARIABLE", "?a"), ("SIGN", "<"), ("VARIABLE", "?b")]),
        (
            "FILTER(?a<?b&&?c>?d)",
            [("SIGN", "<"), ("VARIABLE", "?b"), ("SIGN", "&&"), ("VARIABLE", "?c"), ("SIGN", ">")],
        ),
        ("?s <a:b> ?o", [("VARIABLE", "?s"), ("IRI", "<a:b>"), ("VARIABLE", "?o")]),
        ("{VALUES (?x) {(1 <a:b>)}}", [("NUMBER", "1"), ("IRI", "<a:b>")]),
        ("{?s ?p (1 <a:b>)}", [("NUMBER", "1"), ("IRI", "<a:b>")]),
        ("FILTER(?a = <a:b>)", [("SIGN", "="), ("IRI", "<a:b>")]),
        ("FILTER ex:f(1<2,?x>3)", [("NUMBER", "1"), ("SIGN", "<"), ("NUMBER", "2")]),
        ('\'a\\\'b\' """c"d"""', [("STRING", "'a\\'b'"), ("STRING", '"""c"d"""')]),
        ("ex:a.b. ex:it\\'s _:x", [("NAME", "ex:a.b"), ("SIGN", "."), ("NAME", "ex:it\\'s"), ("NAME", "_:x")]),
        ("'a'@en-GB^^<a:b>", [("STRING", "'a'"), ("TAG", "@en-GB"), ("SIGN", "^^"), ("IRI", "<a:b>")]),
        ("1.5e-3 .5 5.", [("NUMBER", "1.5e-3"), ("NUMBER", ".5"), ("NUMBER", "5"), ("SIGN", ".")]),
        ("a # b\nc", [("WORD", "a"), ("WORD", "c")]),
    ],
)
def test_tokens(text: str, expected: list[tuple[str, str]]) -> None:
    """Tokens are those of SPARQL's grammar; `<` is an operator only after an operand of an expression."""
    found = kinds(text)
    assert any(found[index : index + len(expected)] == expected for index in range(len(found)))


def test_long_texts_take_linear_time() -> None:
    """Long texts of pieces that could cause long lookahead are split within seconds each."""
    began = time.process_time()
    for piece in ("<", "'", "(", "a.", "a:b..", "<a", "'''\"", "\\", "1<", "a-", "😀.", "-"):
        for text in (piece * 8_000, f"a:b{piece * 8_000}c", f"'''{piece * 8_000}"):
            assert all(token.kind in Kind for token in tokens(text))
    assert time.process_time() - began < 8
