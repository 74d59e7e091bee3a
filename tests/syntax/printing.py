"""Syntax trees as text, and trees without their text-dependent parts, for comparing both."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

from pyoxigraph import NamedNode, Triple

from kg.rules.form import TripleTerm, Variable
from kg.syntax import tree
from kg.syntax.tree import Span

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.rules.form import Pattern

__all__ = ["group_text", "path_text", "plain", "template_text", "term_text", "values_text"]

T = TypeVar("T")
NOWHERE = Span(0, 0)


def plain(node: T) -> T:
    """Return a tree with equal spans everywhere and no text in groups."""
    if isinstance(node, tuple):
        return type(node)(map(plain, node))
    if isinstance(node, Span):
        return NOWHERE  # type: ignore[return-value]  # a span
    if not is_dataclass(node) or isinstance(node, type):
        return node
    changed: dict[str, Any] = {field.name: plain(getattr(node, field.name)) for field in fields(node)}
    if isinstance(node, tree.Group):
        changed["text"] = ""
    return replace(node, **changed)


def term_text(term: Pattern) -> str:
    """Return a term in SPARQL; a variable that begins with `.` is the label of a blank node."""
    if isinstance(term, Variable):
        return f"_:{term.name[1:]}" if term.name.startswith(".") else f"?{term.name}"
    if isinstance(term, TripleTerm | Triple):
        return f"<<( {term_text(term.subject)} {term_text(term.predicate)} {term_text(term.object)} )>>"
    return str(term)


def path_text(path: tree.Path) -> str:
    """Return a path with brackets around every part."""
    if isinstance(path, tree.Inverse):
        return f"^{_part(path.path)}"
    if isinstance(path, tree.Sequence):
        return "/".join(map(_part, path.parts))
    if isinstance(path, tree.Alternative):
        return "|".join(map(_part, path.parts))
    if isinstance(path, tree.Repeat):
        return _part(path.path) + ("+" if path.least else "*" if path.many else "?")
    if isinstance(path, tree.Negated):
        return f"!({'|'.join([*map(str, path.forward), *(f'^{step}' for step in path.backward)])})"
    return term_text(path)


def _part(path: tree.Path) -> str:
    return str(path) if isinstance(path, NamedNode) else f"({path_text(path)})"


def template_text(triples: Iterable[tree.TriplePattern]) -> str:
    """Return the triples of a template."""
    return " ".join(f"{term_text(t.subject)} {path_text(t.predicate)} {term_text(t.object)} ." for t in triples)


def values_text(block: tree.ValuesBlock) -> str:
    """Return VALUES without its keyword."""
    rows = " ".join(f"({' '.join('UNDEF' if cell is None else term_text(cell) for cell in row)})" for row in block.rows)
    return f"({' '.join(map(term_text, block.variables))}) {{ {rows} }}"


def group_text(group: tree.Group) -> str:
    """Return a group in braces."""
    return f"{{ {' '.join(map(_node_text, group.nodes))} }}"


def _node_text(node: tree.Node) -> str:
    if isinstance(node, tree.TriplePattern):
        return template_text((node,))
    if isinstance(node, tree.Filter):
        return f"FILTER {node.expression.text}"
    if isinstance(node, tree.Exists):
        return f"FILTER {'NOT ' if node.negated else ''}EXISTS {group_text(node.group)}"
    if isinstance(node, tree.Bind):
        return f"BIND ({node.expression.text} AS {term_text(node.variable)})"
    if isinstance(node, tree.ValuesBlock):
        return f"VALUES {values_text(node)}"
    if isinstance(node, tree.Optional):
        return f"OPTIONAL {group_text(node.group)}"
    if isinstance(node, tree.Minus):
        return f"MINUS {group_text(node.group)}"
    if isinstance(node, tree.Union):
        return " UNION ".join(map(group_text, node.groups))
    if isinstance(node, tree.GraphBlock):
        return f"GRAPH {term_text(node.name)} {group_text(node.group)}"
    return f"{{ {_select_text(node)} }}"


def _select_text(node: tree.SubSelect) -> str:
    columns = " ".join(map(_column_text, node.projections)) or "*"
    keys = "".join(f" {_column_text(key)}" for key in node.keys)
    grouped = f" GROUP BY{keys}" if keys else ""
    having = f" HAVING {' '.join(f'({expression.text})' for expression in node.having)}" if node.having else ""
    distinct = "DISTINCT " if node.distinct else ""
    return f"SELECT {distinct}{columns} WHERE {group_text(node.group)}{grouped}{having}{' LIMIT 1' * node.sliced}"


def _column_text(column: tree.Projection) -> str:
    name = term_text(column.variable)
    return f"({column.expression.text} AS {name})" if column.expression else name
