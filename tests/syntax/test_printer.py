from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.rules.form import Variable
from kg.syntax import tree
from kg.syntax.names import shorten
from kg.syntax.parser import parse_rq
from kg.syntax.printer import path_text, renamed

if TYPE_CHECKING:
    from pyoxigraph import NamedNode

PREFIXES = {"": "http://e/"}


def name(term: NamedNode | Variable) -> str:
    """Return the text of a predicate."""
    return f"?{term.name}" if isinstance(term, Variable) else shorten(term.value, PREFIXES)


@pytest.mark.parametrize(
    "text",
    [
        ":a",
        "^:a",
        ":a/:b/:c",
        ":a|:b",
        "(:a/:b)|:c",
        "(:a|:b)/:c",
        "^(:a/:b)",
        "(:a/:b)+",
        ":a*",
        ":a?",
        ":a+",
        "(:a+)?",
        "!(:a)",
        "!(:a|^:b)",
        "!(:a)/:b",
    ],
)
def test_a_path_is_printed_as_it_is_written(text: str) -> None:
    """Operators keep their operands, with brackets where they are needed."""
    (pattern,) = parse_rq(f"PREFIX : <http://e/> CONSTRUCT {{}} WHERE {{ ?x {text} ?y }}", "x.rq").rules[0].group.nodes
    assert isinstance(pattern, tree.TriplePattern)
    assert path_text(pattern.predicate, name) == text


def test_only_variables_are_renamed() -> None:
    """Texts and comments with the same letters stay, and so does the end of the text."""
    text = 'SELECT ?x { ?x :p "?x", ?xy . FILTER(?x < 2) } # ?x'
    assert renamed(text, {"x": "other"}) == 'SELECT ?other { ?other :p "?x", ?xy . FILTER(?other < 2) } # ?x'
