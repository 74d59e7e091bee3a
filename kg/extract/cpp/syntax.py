"""The concrete syntax of C++: the parser, and what its nodes say.

Nothing here knows of ROS or of other files. Functions take nodes of tree-sitter's C++ grammar
(github.com/tree-sitter/tree-sitter-cpp); none walks a tree deeper than a fixed bound, so that hostile
nesting costs no stack.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import tree_sitter_cpp
from tree_sitter import Language, Parser, Query, QueryCursor, Range

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node, Tree

__all__ = [
    "LANGUAGE",
    "Callee",
    "Part",
    "arguments",
    "callee",
    "captures",
    "declared_name",
    "literal",
    "outward",
    "parse",
    "parse_range",
    "parts",
    "simple_name",
    "split_scope",
    "template_arguments",
    "text",
    "unwrap",
]

LANGUAGE: Final = Language(tree_sitter_cpp.language())

_ESCAPES: Final = {"n": "\n", "t": "\t", "r": "\r", "0": "\0", "a": "\a", "b": "\b", "f": "\f", "v": "\v"}
_WRAPPERS: Final = frozenset({"parenthesized_expression", "condition_clause"})
_DECLARATORS: Final = frozenset(
    {
        "pointer_declarator",
        "reference_declarator",
        "array_declarator",
        "function_declarator",
        "init_declarator",
        "parenthesized_declarator",
        "attributed_declarator",
    }
)
_NO_ARGUMENTS: Final = frozenset({"comment", "preproc_if", "preproc_ifdef", "ERROR"})
_DEEPEST: Final = 60


@cache
def _parser() -> Parser:
    return Parser(LANGUAGE)


def captures(query: Query, node: Node) -> dict[str, list[Node]]:
    """Return what a query captures below a node, by the names of the captures, in the order of the source.

    The order in which tree-sitter gives them is none that can be relied on.
    """
    found = QueryCursor(query).captures(node)
    return {name: sorted(nodes, key=lambda one: (one.start_byte, -one.end_byte)) for name, nodes in found.items()}


def parse(source: bytes) -> Tree:
    """Return the tree of `source`; never fails, errors are nodes of it."""
    return _parser().parse(source)


def parse_range(source: bytes, node: Node) -> Tree:
    """Return the tree of the bytes of `node` alone, at their places in `source`."""
    span = Range(node.start_point, node.end_point, node.start_byte, node.end_byte)
    return Parser(LANGUAGE, included_ranges=[span]).parse(source)


def text(node: Node) -> str:
    """Return the source of a node, as written."""
    raw = node.text
    return raw.decode("utf-8", "replace") if raw else ""


def outward(node: Node, bound: int = _DEEPEST) -> Iterator[Node]:
    """Yield the parents of a node from the inside out, at most `bound` of them."""
    parent = node.parent
    while parent is not None and bound:
        yield parent
        parent = parent.parent
        bound -= 1


def unwrap(node: Node) -> Node:
    """Return the expression within parentheses, casts and address-of."""
    for _ in range(_DEEPEST):
        inner: Node | None = None
        if node.type in _WRAPPERS:
            inner = next((child for child in node.named_children if child.type != "comment"), None)
        elif node.type == "cast_expression":
            inner = node.child_by_field_name("value")
        elif node.type == "pointer_expression":
            inner = node.child_by_field_name("argument")
        if inner is None:
            return node
        node = inner
    return node


def arguments(node: Node | None) -> list[Node]:
    """Return the expressions of an argument list, an initialiser list or a template argument list.

    `"text" MACRO` does not parse: there the error node stands for both.
    """
    found: list[Node] = []
    for child in node.named_children if node is not None else ():
        if child.type == "ERROR" and found and found[-1].type == "string_literal":
            found[-1] = child
        elif child.type not in _NO_ARGUMENTS:
            found.append(child)
    return found


@dataclass(frozen=True, slots=True)
class Callee:
    """What a call calls: `receiver.scope::name<template>`."""

    name: str
    receiver: Node | None = None
    scope: tuple[str, ...] = ()
    template: Node | None = None
    arrow: bool = False


def callee(function: Node) -> Callee | None:
    """Return what the `function` of a call names; None for computed functions."""
    receiver, arrow = None, False
    if function.type == "field_expression":
        receiver = function.child_by_field_name("argument")
        operator = function.child_by_field_name("operator")
        arrow = operator is not None and operator.type == "->"
        field = function.child_by_field_name("field")
        if field is None:
            return None
        function = field
    scope: list[str] = []
    template = None
    for _ in range(_DEEPEST):
        kind = function.type
        if kind in ("identifier", "field_identifier", "type_identifier", "primitive_type", "destructor_name"):
            return Callee(text(function), receiver, tuple(scope), template, arrow)
        inner: Node | None = None
        if kind in ("template_function", "template_method", "template_type"):
            template = function.child_by_field_name("arguments")
            inner = function.child_by_field_name("name")
        elif kind == "qualified_identifier":
            outer = function.child_by_field_name("scope")
            if outer is not None:
                scope.append(simple_name(outer))
            inner = function.child_by_field_name("name")
        elif kind == "dependent_name":
            inner = next(iter(function.named_children), None)
        if inner is None:
            return None
        function = inner
    return None


def simple_name(node: Node) -> str:
    """Return the last word of a name or type, without scope and template arguments."""
    for _ in range(_DEEPEST):
        inner: Node | None = None
        if node.type in ("qualified_identifier", "template_type", "template_function", "template_method"):
            inner = node.child_by_field_name("name")
        elif node.type == "type_descriptor":
            inner = node.child_by_field_name("type")
        elif node.type in ("dependent_name", "dependent_type"):
            inner = node.named_children[0] if node.named_children else None
        if inner is None:
            return text(node)
        node = inner
    return text(node)


def split_scope(node: Node) -> tuple[tuple[str, ...], Node]:
    """Return the scopes of a qualified name from the outside in, and the innermost name node."""
    scope: list[str] = []
    for _ in range(_DEEPEST):
        if node.type in ("dependent_type", "dependent_name") and node.named_children:
            node = node.named_children[0]
            continue
        if node.type != "qualified_identifier":
            break
        outer, inner = node.child_by_field_name("scope"), node.child_by_field_name("name")
        if outer is not None:
            scope.append(simple_name(outer))
        if inner is None:
            break
        node = inner
    return tuple(scope), node


@dataclass(frozen=True, slots=True)
class Part:
    """One name of a qualified name, with its template arguments."""

    name: str
    template: Node | None = None


def parts(node: Node) -> list[Part]:
    """Return the names of a qualified name or type from the outside in."""
    found: list[Part] = []
    for _ in range(_DEEPEST):
        inner: Node | None = None
        if node.type == "qualified_identifier":
            outer = node.child_by_field_name("scope")
            if outer is not None:
                found.append(_part(outer))
            inner = node.child_by_field_name("name")
        elif node.type == "type_descriptor":
            inner = node.child_by_field_name("type")
        elif node.type in ("dependent_type", "dependent_name"):
            inner = node.named_children[0] if node.named_children else None
        if inner is None:
            found.append(_part(node))
            break
        node = inner
    return found


def _part(node: Node) -> Part:
    if node.type in ("template_type", "template_function", "template_method"):
        name = node.child_by_field_name("name")
        return Part(text(name) if name is not None else "", node.child_by_field_name("arguments"))
    return Part(text(node))


def template_arguments(node: Node) -> list[Node]:
    """Return the template arguments of the innermost name of a type or function."""
    _, inner = split_scope(node)
    return arguments(inner.child_by_field_name("arguments")) if inner.type.startswith("template_") else []


def declared_name(declarator: Node | None) -> Node | None:
    """Return the name that a declarator declares, below pointers, references, arrays and parameter lists."""
    for _ in range(_DEEPEST):
        if declarator is None or declarator.type not in _DECLARATORS:
            break
        inner = declarator.child_by_field_name("declarator")
        if inner is None:
            inner = next((c for c in declarator.named_children if c.type not in ("type_qualifier", "comment")), None)
        declarator = inner
    if declarator is None or declarator.type.startswith("abstract_"):
        return None
    return declarator


def literal(node: Node) -> str | None:
    """Return the value of a string or character literal (with a suffix, too), None for other nodes."""
    if node.type == "user_defined_literal" and node.named_children:
        node = node.named_children[0]
    if node.type == "raw_string_literal":
        content = next((child for child in node.named_children if child.type == "raw_string_content"), None)
        return text(content) if content is not None else ""
    if node.type not in ("string_literal", "char_literal"):
        return None
    parts = []
    for child in node.named_children:
        piece = text(child)
        if child.type == "escape_sequence":
            piece = _ESCAPES.get(piece[1:2], piece[1:])
        parts.append(piece)
    return "".join(parts)
