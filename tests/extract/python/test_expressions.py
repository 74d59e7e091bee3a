"""Expressions of Python in the intermediate form."""

from __future__ import annotations

import pytest

from kg.extract.python.expressions import expression_of
from kg.symbolic import form
from kg.symbolic.spelling import spelled


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a.b(c, 'd')[1]", 'a.b(c, "d")[1]'),
        ("a + b + c - 1", "a + b + c - 1"),
        ("x if y else 'z'", 'y ? x : "z"'),
        ("not a is None", "not a == none"),
        ("a < b <= c", "a < b and b <= c"),
        ("0x10", "0x10"),
        ("'a' \"b\" r'\\n'", '"ab\\\\n"'),
        ("'\\u00e9\\t'", '"é\\t"'),
        ("f'{{a}}{x:>3}/{y}'", '"{{a}}{:>3}/{}".format(x, y)'),
    ],
)
def test_an_expression_keeps_its_structure(text: str, shown: str) -> None:
    """Operators, calls, members and literals are lowered each to its element."""
    assert spelled(expression_of(text)) == shown


def test_arguments_by_name_are_apart() -> None:
    """Arguments by name, `*` and `**` are distinguished."""
    found = expression_of("f(a, *b, c=1, **d)")
    assert isinstance(found, form.Call)
    assert [type(one) for one in found.arguments] == [form.Name, form.Spread]
    assert [name for name, _ in found.keywords] == ["c", "**"]


@pytest.mark.parametrize("text", ["", "a b", "x = 1", "(" * 4000 + "1" + ")" * 4000, "f(" * 4000 + ")" * 4000, "'a"])
def test_any_text_has_a_form(text: str) -> None:
    """An invalid or too deep expression gives a form without an error."""
    assert expression_of(text) is not None
