"""Where the variables of a rule as written occur: all mentions, and those places that bind."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, TypeAlias

from kg.rules.form import Pattern, Variable, variables_of
from kg.syntax.tree import (
    Bind,
    Expression,
    Filter,
    GraphBlock,
    Node,
    Path,
    SubSelect,
    TriplePattern,
    Union,
    ValuesBlock,
    groups_of,
    visible,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


Uses: TypeAlias = "Counter[str]"
"""The names of variables with how often they occur."""


def uses(nodes: Iterable[Node], *, binding: bool = False) -> Uses:
    """Count mentions of variables at any depth; with `binding` only where they may be bound, not in expressions."""
    return Counter(name for node in nodes for name in _names(node, binding=binding))


def _names(node: Node, *, binding: bool) -> Iterator[str]:
    if isinstance(node, TriplePattern):
        yield from _pattern_names(node)
    elif isinstance(node, Filter):
        yield from _expression_names(node.expression, binding=binding)
    elif isinstance(node, Bind):
        yield node.variable.name
        yield from _expression_names(node.expression, binding=binding)
    elif isinstance(node, ValuesBlock):
        yield from (variable.name for variable in node.variables)
    elif isinstance(node, SubSelect):
        yield from _select_names(node, binding=binding)
    else:
        if isinstance(node, GraphBlock) and isinstance(node.name, Variable):
            yield node.name.name
        for group in groups_of(node):
            yield from uses(group.nodes, binding=binding).elements()


def _expression_names(expression: Expression, *, binding: bool) -> Iterator[str]:
    if not binding:
        yield from expression.variables
    for exists in expression.exists:
        yield from uses(exists.group.nodes, binding=binding).elements()


def _select_names(node: SubSelect, *, binding: bool) -> Iterator[str]:
    yield from uses(node.group.nodes, binding=binding).elements()
    for column in (*node.projections, *node.keys):
        yield column.variable.name
        if column.expression:
            yield from _expression_names(column.expression, binding=binding)
    for condition in node.having:
        yield from _expression_names(condition, binding=binding)


def _pattern_names(node: TriplePattern) -> Iterator[str]:
    yield from (variable.name for variable in _variables(node.subject))
    yield from (variable.name for variable in _variables(node.predicate))
    yield from (variable.name for variable in _variables(node.object))


def _variables(part: Pattern | Path) -> Iterator[Variable]:
    """Yield the variables of a position; paths have none but one that is the whole predicate."""
    if isinstance(part, Variable):
        yield part
    else:
        yield from variables_of(part)  # type: ignore[arg-type]  # a path has no variables and is passed over


def possible(nodes: Iterable[Node]) -> frozenset[str]:
    """Return the names that some solution of a group may bind, those of blank nodes left out (SPARQL 1.1, 18.2.1)."""
    return frozenset(name for name in visible(nodes) if not name.startswith("."))


def certain(nodes: Iterable[Node]) -> frozenset[str]:
    """Return the names that each solution of a group binds; fewer when in doubt."""
    return frozenset(name for node in nodes for name in _bound_by(node))


def _bound_by(node: Node) -> Iterable[str]:
    if isinstance(node, TriplePattern):
        return possible([node])
    if isinstance(node, ValuesBlock):
        columns = enumerate(node.variables)
        return (variable.name for index, variable in columns if all(row[index] is not None for row in node.rows))
    if isinstance(node, SubSelect):
        return _selected(node)
    if isinstance(node, Union):
        return frozenset.intersection(*(certain(group.nodes) for group in node.groups))
    if isinstance(node, GraphBlock):
        return certain(node.group.nodes) | ({node.name.name} if isinstance(node.name, Variable) else set())
    return ()


def _selected(node: SubSelect) -> frozenset[str]:
    """Return the columns of a sub-SELECT that each of its rows has; an expression may fail, unless it only counts."""
    inner = certain(node.group.nodes)
    if not node.projections:
        return inner
    counted = {column.variable.name for column in node.projections if column.expression and _counts(column.expression)}
    return inner.intersection(column.variable.name for column in node.projections) | counted


def _counts(expression: Expression) -> bool:
    calls = expression.aggregates
    return len(calls) == 1 and calls[0].function == "COUNT" and calls[0].text == expression.text
