"""Declarations at the beginning of a text."""

from __future__ import annotations

import pytest

from kg.syntax.prologue import declaration


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("ASK {}", "PREFIX a: <urn:a>\nASK {}"),
        ("# why\n\nASK {}", "# why\n\nPREFIX a: <urn:a>\nASK {}"),
        ("PREFIX b: <urn:b> ASK {}", "PREFIX b: <urn:b>\nPREFIX a: <urn:a> ASK {}"),
        ("PREFIX b: <urn:b>\nASK {}", "PREFIX b: <urn:b>\nPREFIX a: <urn:a>\nASK {}"),
        ("", "PREFIX a: <urn:a>\n"),
    ],
)
def test_where_declarations_go(text: str, result: str) -> None:
    """A declaration is inserted after existing ones, else before the query and after its comment."""
    at, line = declaration(text, {"a": "urn:a"})
    assert text[:at] + line + text[at:] == result


def test_declarations_of_turtle() -> None:
    """In Turtle a declaration has the form of Turtle, and follows those of either form."""
    text = "# Shapes\n\n@prefix b: <urn:b> .\nb:one b:two b:three .\n"
    at, lines = declaration(text, {"a": "urn:a", "c": "urn:c"}, turtle=True)
    assert (at, lines) == (text.index("b:one"), "@prefix a: <urn:a> .\n@prefix c: <urn:c> .\n")
