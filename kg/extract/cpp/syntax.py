"""The concrete syntax of C++: the parser, and access to its nodes.

Functions take nodes of tree-sitter's C++ grammar (github.com/tree-sitter/tree-sitter-cpp). None walks a tree deeper
than a fixed bound, because hostile nesting would exhaust the stack.
"""

from __future__ import annotations

from functools import cache
from typing import Final, NamedTuple

import tree_sitter_cpp
from tree_sitter import Language, Node, Parser, Point, Query, QueryCursor, Range, Tree

LANGUAGE: Final = Language(tree_sitter_cpp.language())

_ESCAPES: Final = {"n": "\n", "t": "\t", "r": "\r", "0": "\0", "a": "\a", "b": "\b", "f": "\f", "v": "\v"}
_DECLARATORS: Final = frozenset(
    {
        "pointer_declarator", "reference_declarator", "array_declarator", "function_declarator", "init_declarator",
        "parenthesized_declarator", "attributed_declarator",
    }
)  # fmt: skip
CLASSES: Final = frozenset({"class_specifier", "struct_specifier", "union_specifier", "enum_specifier"})
PLAIN: Final = frozenset({"identifier", "field_identifier", "type_identifier", "primitive_type"})
"""Names that have no parts."""
_NO_ARGUMENTS: Final = frozenset({"comment", "preproc_if", "preproc_ifdef", "ERROR"})
_DEEPEST: Final = 60


@cache
def _parser() -> Parser:
    return Parser(LANGUAGE)


def captures(query: Query, node: Node) -> dict[str, list[Node]]:
    """Return the captures of a query below a node, by name, in the order of the source.

    The order of tree-sitter is not reliable.
    """
    by_name = QueryCursor(query).captures(node)
    return {name: sorted(nodes, key=lambda one: (one.start_byte, -one.end_byte)) for name, nodes in by_name.items()}


def parse(source: bytes) -> Tree:
    """Return the tree of `source`; never fails, errors are nodes of it."""
    return _parser().parse(source)


def parse_range(source: bytes, node: Node) -> Tree:
    """Return the tree of the bytes of `node`, with the semicolon after it, as a statement at its place in `source`."""
    spans = [Range(node.start_point, node.end_point, node.start_byte, node.end_byte)]
    end = source.find(b";", node.end_byte)
    if end >= 0:
        place = Point(node.end_point[0], node.end_point[1] + end - node.end_byte)
        spans.append(Range(place, Point(place[0], place[1] + 1), end, end + 1))
    return Parser(LANGUAGE, included_ranges=spans).parse(source)


def text(node: Node) -> str:
    """Return the source of a node, as written."""
    raw = node.text
    return raw.decode("utf-8", "replace") if raw else ""


def line_of(node: Node) -> int:
    """Return the line where a node begins, from 1."""
    return int(node.start_point[0]) + 1


def arguments(node: Node | None) -> list[Node]:
    """Return the expressions of an argument list, an initialiser list or a template argument list.

    `"text" MACRO` does not parse: the error node represents both.
    """
    arguments: list[Node] = []
    for child in node.named_children if node is not None else ():
        if child.type == "ERROR" and arguments and arguments[-1].type == "string_literal":
            arguments[-1] = child
        elif child.type not in _NO_ARGUMENTS:
            arguments.append(child)
    return arguments


def of_type(node: Node | None, *kinds: str) -> list[Node]:
    """Return the named children of some types of a node."""
    return [child for child in node.named_children if child.type in kinds] if node is not None else []


class Part(NamedTuple):
    """One name of a qualified name, with its template arguments."""

    name: str
    template: Node | None = None


def parts(node: Node) -> list[Part]:
    """Return the names of a qualified name or type from the outside in."""
    if node.type in PLAIN:
        return [Part(text(node))]
    parts: list[Part] = []
    for _ in range(_DEEPEST):
        inner: Node | None = None
        if node.type == "qualified_identifier":
            outer = node.child_by_field_name("scope")
            if outer is not None:
                parts.append(_part(outer))
            inner = node.child_by_field_name("name")
        elif node.type == "type_descriptor":
            inner = node.child_by_field_name("type")
        elif node.type in ("dependent_type", "dependent_name"):
            inner = node.named_children[0] if node.named_children else None
        if inner is None:
            parts.append(_part(node))
            break
        node = inner
    return parts


def _part(node: Node) -> Part:
    if node.type in CLASSES:  # a class that is defined where a member of it is declared
        named = node.child_by_field_name("name")
        return _part(named) if named is not None else Part("")
    if node.type in ("template_type", "template_function", "template_method"):
        name = node.child_by_field_name("name")
        return Part(text(name) if name is not None else "", node.child_by_field_name("arguments"))
    return Part(text(node))


def simple_name(node: Node) -> str:
    """Return the last word of a name or type, without scope and template arguments."""
    names = parts(node)
    return names[-1].name if names else text(node)


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
    if declarator.type == "qualified_identifier":  # a pointer to a member: `void (Node::*callback)(int)`
        pointer = declarator.child_by_field_name("name")
        if pointer is not None and pointer.type == "pointer_type_declarator":
            return pointer.child_by_field_name("declarator")
    return declarator


def is_function_pointer(declarator: Node) -> bool:
    """Check whether a declarator with parameters declares a pointer to a function: `bool (*check)(int)`."""
    inner = declarator.child_by_field_name("declarator")
    return inner is not None and inner.type == "parenthesized_declarator"


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
