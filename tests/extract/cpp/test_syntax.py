from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from extract.cpp.packages import names_of
from hypothesis import given
from hypothesis import strategies as st
from tree_sitter import Query

from kg.extract.cpp import syntax

if TYPE_CHECKING:
    from tree_sitter import Node

TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=30)


@lru_cache
def query(kind: str) -> Query:
    """Return the query for a kind; compiling it takes longer than parsing an example."""
    return Query(syntax.LANGUAGE, f"({kind}) @it")


def first(source: str, kind: str) -> Node:
    """Return the first node of a kind."""
    tree = syntax.parse(source.encode())
    return syntax.captures(query(kind), tree.root_node)["it"][0]


@given(TEXTS)
def test_literals_keep_their_text(text: str) -> None:
    """A string literal is read as the text it denotes."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("??", "?\\?")
    assert syntax.literal(first(f'auto s = "{escaped}";', "string_literal")) == text


@given(TEXTS.filter(lambda text: ")x" not in text))
def test_raw_literals_keep_their_text(text: str) -> None:
    """A raw string literal is read unchanged."""
    assert syntax.literal(first(f'auto s = R"x({text})x";', "raw_string_literal")) == text


def test_a_text_before_a_macro_is_one_argument() -> None:
    """`"text" MACRO`, which is a syntax error, remains one argument."""
    call = first('void g() { f("/" NAME, 1); }', "call_expression")
    assert len(syntax.arguments(call.child_by_field_name("arguments"))) == 2


def test_signals_of_qt_do_not_end_the_reading() -> None:
    """The grammar completes `Item *,` in a Qt macro with an empty name; the rest of the program is read."""
    connect = "QObject::connect(&tree, SIGNAL(collapsed(Item *)), this, SLOT(shown(Item *)));"
    source = f'int main() {{ ros::NodeHandle nh; {connect} nh.advertise<std_msgs::String>("x", 1); }}'
    assert names_of(source) == {"x"}
