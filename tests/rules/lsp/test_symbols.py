"""Symbols of any text, including incomplete text in an editor."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.rules.lsp.symbols import occurrences, symbol_at


@pytest.mark.parametrize("name", ["mine/a.rq", "mine/a.srl", "mine/a.ttl", "mine/a.md", "kg.toml"])
@given(
    text=st.lists(
        st.sampled_from(
            [*"?:ab {}.#<>\"'\\\n", "sh:construct ", '"""', "PREFIX a: <urn:a#>", "RULE ", "```turtle\n", "\\UFFFFFFFF"]
        ),
        max_size=30,
    ).map("".join),
    offset=st.integers(0, 100),
)
def test_any_text_is_answered(name: str, text: str, offset: int) -> None:
    """In any text, a symbol occurs at its reported place."""
    path = Path(name)
    symbol = symbol_at(text, offset, path, "mine/a", {"mine/b"})
    if symbol is not None:
        found = [(each.start, each.end) for each in occurrences(symbol, text, path)]
        assert (symbol.start, symbol.end) in found
        assert all(0 <= start <= end <= len(text) for start, end in found)


def test_scopes_of_variables() -> None:
    """A variable belongs to its rule; `WHERE DATA` does not start another."""
    text = "RULE { ?a a ?b } WHERE DATA { ?a a ?b }\nDATA { }\nRULE { ?a a ?b } WHERE { ?a a ?b }"
    symbol = symbol_at(text, text.index("?a") + 1, Path("a.srl"), "a", ())
    assert symbol is not None
    assert len(list(occurrences(symbol, text, Path("a.srl")))) == 2


def test_escapes_in_the_strings_of_shapes() -> None:
    """Places in a string account for preceding escapes."""
    text = '@prefix sh: <http://www.w3.org/ns/shacl#> . [] sh:select "SELECT ?a { ?b \\"x\\" ?a }" .'
    symbol = symbol_at(text, text.rindex("?a"), Path("a.ttl"), "a", ())
    assert symbol is not None
    assert [text[each.start - 1 : each.end] for each in occurrences(symbol, text, Path("a.ttl"))] == ["?a", "?a"]
