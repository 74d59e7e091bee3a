"""Where Python code meets tree-sitter: the parser, queries, and texts of nodes.

The grammar of tree-sitter covers Python 2 as well (`print x`, `exec code`, backticks, `except X, error`).
"""

from __future__ import annotations

from functools import cache
from typing import Final

import tree_sitter_python
from tree_sitter import Language, Node, Parser, Query, QueryCursor, Tree

_PATTERNS: Final = """
(call) @call
(import_statement) @import
(import_from_statement) @import
"""


@cache
def _language() -> Language:
    return Language(tree_sitter_python.language())


@cache
def _query(patterns: str) -> Query:
    return Query(_language(), patterns)


def parse(source: bytes) -> Tree:
    """Return the syntax tree of a file; what does not parse is in ERROR nodes."""
    return Parser(_language()).parse(source)


def captures(root: Node) -> dict[str, list[Node]]:
    """Return the calls and imports of a file by kind, outer ones first."""
    captured = QueryCursor(_query(_PATTERNS)).captures(root)
    for nodes in captured.values():  # they come in the order of their addresses
        nodes.sort(key=lambda node: (node.start_byte, -node.end_byte))
    return captured


def first_error(root: Node) -> int | None:
    """Return the line of the first part that does not parse."""
    if not root.has_error:
        return None
    errors = QueryCursor(_query("(ERROR) @error (MISSING) @error")).captures(root).get("error", ())
    return min((node.start_point.row + 1 for node in errors), default=None)


def code(node: Node | None) -> str:
    """Return the text of a node, and nothing for no node."""
    return (node.text or b"").decode("utf-8", "replace") if node is not None else ""


def line_of(node: Node) -> int:
    """Return the line where a node begins, from 1."""
    return int(node.start_point[0]) + 1


def operands_of(node: Node, sign: str) -> list[Node]:
    """Return the operands of a chain of one left-associative operator, in order."""
    operands: list[Node] = []
    current: Node | None = node
    while current is not None and current.type == node.type and code(current.child_by_field_name("operator")) == sign:
        right = current.child_by_field_name("right")
        if right is not None:
            operands.append(right)
        current = current.child_by_field_name("left")
    return [*([current] if current is not None else []), *reversed(operands)]


def strip_parentheses(node: Node) -> Node:
    """Return the expression inside of any parentheses around it."""
    while node.type == "parenthesized_expression" and node.named_child_count:
        inner = [child for child in node.named_children if child.type != "comment"]
        if len(inner) != 1:
            return node
        node = inner[0]
    return node


def argument_nodes(call: Node) -> list[Node]:
    """Return the arguments of a call (or the bases of a class) as written, without comments."""
    arguments = call.child_by_field_name("arguments") or call.child_by_field_name("superclasses")
    if arguments is None:
        return []
    if arguments.type == "generator_expression":
        return [arguments]
    return [child for child in arguments.named_children if child.type != "comment"]
