from __future__ import annotations

import pytest
import tree_sitter_python
from tree_sitter import Language, Parser

from kg.extract.manifests.setup_py import Piece, Values


def plain(value: object) -> object:
    """Return a value with its pieces as strings."""
    if isinstance(value, Piece):
        return value.text
    if isinstance(value, list):
        return [plain(item) for item in value]
    return {key: plain(item) for key, item in value.items()} if isinstance(value, dict) else value


def evaluate(expression: str) -> object:
    """Evaluate an expression in which `a` is known to be "x"."""
    tree = Parser(Language(tree_sitter_python.language())).parse(expression.encode())
    values = Values()
    values.names["a"] = Piece("x", 1)
    return plain(values.of(tree.root_node.named_children[0].named_children[0]))


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("'s'", "s"),
        ("r'''s'''", "s"),
        ("'s' 't'", "st"),
        ("'s \\\n t'", "s  t"),
        (r"'\'s\'\n'", "'s'\n"),
        ("('s')", "s"),
        ("a", "x"),
        ("b", None),
        ("a + 's'", "xs"),
        ("a + b", None),
        ("f'{a}/{b}'", "x/{}"),
        ("'%s-%s' % (a, 's')", "x-s"),
        ("'{}-{}'.format(a, 's')", "x-s"),
        ("[a, 's', b]", ["x", "s", None]),
        ("[a] + ['s'] + b", ["x", "s"]),
        ("[*['s'], a]", ["s", "x"]),
        ("{'k': a, b: 's'}", {"k": "x"}),
        ("[f'{i}!' for i in ('p', 'q')]", ["p!", "q!"]),
        ("[i for i in b]", []),
        ("list(['s'])", ["s"]),
        ("glob('*')", None),
        ("lambda: 1", None),
    ],
)
def test_values(expression: str, expected: object) -> None:
    """Literals, known names and operations on text have values; everything else has none."""
    assert evaluate(expression) == expected
