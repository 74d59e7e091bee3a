"""Where the variables of a rule as written occur: all mentions, and those places that bind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import TypeAlias

from kg.rules.form import Variable, variables_of
from kg.syntax import tree

Uses: TypeAlias = "Counter[str]"
"""The names of variables with how often they occur."""


def uses(nodes: Iterable[tree.Node], *, binding: bool = False) -> Uses:
    """Count mentions of variables at any depth; with `binding` only where they may be bound, not in expressions."""
    return Counter(name for node in nodes for name in _names(node, binding=binding))


def _names(node: tree.Node, *, binding: bool) -> Iterator[str]:
    if isinstance(node, tree.TriplePattern):
        # A path has no variables but one that is the whole predicate.
        for part in (node.subject, node.predicate, node.object):
            yield from (variable.name for variable in variables_of(part))  # type: ignore[arg-type]  # paths are passed over
    elif isinstance(node, tree.Bind):
        yield node.variable.name
    elif isinstance(node, tree.ValuesBlock):
        yield from (variable.name for variable in node.variables)
    elif isinstance(node, tree.SubSelect):
        yield from (column.variable.name for column in (*node.projections, *node.keys))
    elif isinstance(node, tree.GraphBlock) and isinstance(node.name, Variable):
        yield node.name.name
    groups = list(tree.groups_of(node))
    for expression in tree.expressions_of(node):
        if not binding:
            yield from expression.variables
        groups += (exists.group for exists in expression.exists)
    for group in groups:
        yield from uses(group.nodes, binding=binding).elements()


def possible(nodes: Iterable[tree.Node]) -> frozenset[str]:
    """Return the names that some solution of a group may bind, those of blank nodes left out (SPARQL 1.1, 18.2.1)."""
    return frozenset(name for name in tree.visible(nodes) if not name.startswith("."))


def certain(nodes: Iterable[tree.Node]) -> frozenset[str]:
    """Return the names that each solution of a group binds; fewer when in doubt."""
    return frozenset(name for node in nodes for name in _bound_by(node))


def _bound_by(node: tree.Node) -> Iterable[str]:
    if isinstance(node, tree.TriplePattern):
        return possible([node])
    if isinstance(node, tree.ValuesBlock):
        columns = enumerate(node.variables)
        return (variable.name for index, variable in columns if all(row[index] is not None for row in node.rows))
    if isinstance(node, tree.SubSelect):
        return _selected(node)
    if isinstance(node, tree.Union):
        return frozenset.intersection(*(certain(group.nodes) for group in node.groups))
    if isinstance(node, tree.GraphBlock):
        return certain(node.group.nodes) | ({node.name.name} if isinstance(node.name, Variable) else set())
    return ()


def _selected(node: tree.SubSelect) -> frozenset[str]:
    """Return the columns of a sub-SELECT that each of its rows has; an expression may fail, unless it only counts."""
    inner = certain(node.group.nodes)
    if not node.projections:
        return inner
    counted = {column.variable.name for column in node.projections if column.expression and _counts(column.expression)}
    return inner.intersection(column.variable.name for column in node.projections) | counted


def _counts(expression: tree.Expression) -> bool:
    calls = expression.aggregates
    return len(calls) == 1 and calls[0].function == "COUNT" and calls[0].text == expression.text
