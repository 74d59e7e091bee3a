from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import given
from hypothesis import strategies as st
from tree_sitter import Query

from kg.extract.cpp import syntax

if TYPE_CHECKING:
    from tree_sitter import Node

TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=30)


def first(source: str, kind: str) -> Node:
    """Return the first node of a kind."""
    tree = syntax.parse(source.encode())
    return syntax.captures(Query(syntax.LANGUAGE, f"({kind}) @it"), tree.root_node)["it"][0]


@given(TEXTS)
def test_literals_keep_their_text(text: str) -> None:
    """A string literal is read as what was written into it."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("??", "?\\?")
    assert syntax.literal(first(f'auto s = "{escaped}";', "string_literal")) == text


@given(TEXTS.filter(lambda text: ")x" not in text))
def test_raw_literals_keep_their_text(text: str) -> None:
    """A raw string literal is read as it stands."""
    assert syntax.literal(first(f'auto s = R"x({text})x";', "raw_string_literal")) == text


def test_callee_names_receiver_scope_and_template() -> None:
    """What a call calls is known in every spelling."""
    called = {}
    for code in ("f(a)", "o.f(a)", "o->f<T>(a)", "a::b::f(a)", "n::f<T>(a)", "o.template f<T>(a)"):
        function = first(f"void g() {{ {code}; }}", "call_expression").child_by_field_name("function")
        assert function is not None
        found = syntax.callee(function)
        assert found is not None
        receiver = syntax.text(found.receiver) if found.receiver is not None else None
        called[code] = (found.name, receiver, found.scope, found.template is not None)
    assert called == {
        "f(a)": ("f", None, (), False),
        "o.f(a)": ("f", "o", (), False),
        "o->f<T>(a)": ("f", "o", (), True),
        "a::b::f(a)": ("f", None, ("a", "b"), False),
        "n::f<T>(a)": ("f", None, ("n",), True),
        "o.template f<T>(a)": ("f", "o", (), True),
    }


def test_unwrap_stops_at_a_bound() -> None:
    """Parentheses nested as no person writes them do not exhaust the stack."""
    deep = "(" * 5000 + "1" + ")" * 5000
    node = syntax.unwrap(first(f"int a = {deep};", "parenthesized_expression"))
    assert node.type == "parenthesized_expression"


def test_a_text_before_a_macro_is_one_argument() -> None:
    """`"text" MACRO`, which does not parse, stays one argument."""
    call = first('void g() { f("/" NAME, 1); }', "call_expression")
    assert len(syntax.arguments(call.child_by_field_name("arguments"))) == 2
