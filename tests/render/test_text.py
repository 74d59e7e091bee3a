from __future__ import annotations

import json
from unicodedata import category

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.render.text import count, printable, printable_json, width


@given(st.text())
def test_nothing_printable_steers_a_terminal(text: str) -> None:
    """No control, format, private or surrogate character remains, and the text can be encoded."""
    shown = printable(text)
    assert not {category(sign) for sign in shown} & {"Cc", "Cf", "Co", "Cs", "Cn"}
    shown.encode()


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("\x1b[31mred", "\\x1b[31mred"),
        ("a\nb\tc", "a b c"),
        ("\u202eabc", "\\u202eabc"),
        ("Zürich 東京", "Zürich 東京"),
    ],
)
def test_what_is_unsafe_is_shown_as_an_escape(text: str, shown: str) -> None:
    """A reader sees the character and its code."""
    assert printable(text) == shown


@given(st.text(alphabet=st.characters()))
def test_json_keeps_its_value_and_steers_no_terminal(text: str) -> None:
    """Unsafe characters are JSON escapes; programs read the same value."""
    written = printable_json(json.dumps(text, ensure_ascii=False))
    assert json.loads(written) == text
    assert not {category(sign) for sign in written} & {"Cc", "Cf", "Cs", "Zl", "Zp"}


def test_wide_characters_count_twice() -> None:
    """Carets are below the right character in East Asian text."""
    assert (width("ab"), width("東京")) == (2, 4)


def test_counts_agree_with_their_noun() -> None:
    """One node, two nodes, three entities."""
    assert (count(1, "node"), count(2000, "node"), count(0, "entity", "entities")) == (
        "1 node",
        "2,000 nodes",
        "0 entities",
    )
