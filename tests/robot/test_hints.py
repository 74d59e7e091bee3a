"""Hints of robot errors have the same style as all others."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOM = Path(__file__).parents[2] / "kg" / "robot"


def _written(node: ast.AST) -> Iterator[ast.expr]:
    """Yield the values passed or stored as hints."""
    given = isinstance(node, ast.keyword) and node.arg == "hint"
    kept = isinstance(node, ast.Assign) and [one.id for one in node.targets if isinstance(one, ast.Name)] == ["hint"]
    if isinstance(node, ast.keyword | ast.Assign) and (given or kept):
        yield node.value


def _begins(value: ast.AST) -> Iterator[str]:
    """Yield the possible beginnings of an expression's text."""
    for choice in value.values if isinstance(value, ast.BoolOp) else (value,):
        first = choice.values[0] if isinstance(choice, ast.JoinedStr) else choice
        if isinstance(first, ast.Constant) and isinstance(first.value, str):
            yield first.value


def test_a_hint_is_a_sentence() -> None:
    """No hint begins with a small letter."""
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in sorted(ROOM.rglob("*.py"))]
    found = [text for tree in trees for node in ast.walk(tree) for value in _written(node) for text in _begins(value)]
    assert len(found) > 20
    assert [text for text in found if text[:1].islower()] == []
