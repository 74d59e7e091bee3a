"""Other names for the variables of a body."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TypeAlias

from kg.rules import form, sparql
from kg.rules.decompose import expressions
from kg.rules.form import Variable, variables_of
from kg.syntax import printer, tree

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


def renamed(body: Iterable[form.Element], names: Mapping[form.Variable, form.Variable]) -> tuple[form.Element, ...]:
    """Return elements with other variables, those inside EXISTS, aggregates and text too."""
    return tuple(_renamed(element, names) for element in body) if names else tuple(body)


def everywhere(body: Iterable[form.Element]) -> frozenset[form.Variable]:
    """Return the variables at any depth, in aggregates too."""
    body = tuple(body)
    inner = [everywhere(element.body) for element in body if isinstance(element, form.Exists | form.Aggregate)]
    return frozenset().union(*inner, *map(form.mentions, body))


def _renamed(element: form.Element, names: Mapping[form.Variable, form.Variable]) -> form.Element:
    if isinstance(element, form.Atom):
        return element.replaced(names)
    if isinstance(element, form.Filter):
        return form.Filter(renamed_expression(element.expression, names))
    if isinstance(element, form.Assignment):
        variable = names.get(element.variable, element.variable)
        return form.Assignment(variable, renamed_expression(element.expression, names))
    if isinstance(element, form.Exists):
        return form.Exists(renamed(element.body, names), element.negated)
    if isinstance(element, form.Values):
        return form.Values(_all(element.variables, names), element.rows)
    if isinstance(element, form.EngineBlock):
        return replace(
            element,
            text=printer.renamed(element.text, _spelt(names)),
            variables=_all(element.variables, names),
            optional=_all(element.optional, names),
        )
    columns = tuple(
        replace(
            column,
            variable=names.get(column.variable, column.variable),
            expression=column.expression and renamed_expression(column.expression, names),
        )
        for column in element.columns
    )
    return form.Aggregate(_all(element.keys, names), columns, renamed(element.body, names))


def renamed_expression(expression: form.Expression, names: Mapping[form.Variable, form.Variable]) -> form.Expression:
    """Return an expression with other variables."""
    spelt = _spelt(names)
    if spelt.keys().isdisjoint(expression.variables):
        return expression
    text = printer.renamed(expression.text, spelt)
    return replace(expression, text=text, variables=expressions.variables(text))


def _spelt(names: Mapping[form.Variable, form.Variable]) -> dict[str, str]:
    return {sparql.spelling(old)[1:]: sparql.spelling(new)[1:] for old, new in names.items()}


def _all(
    variables: tuple[form.Variable, ...], names: Mapping[form.Variable, form.Variable]
) -> tuple[form.Variable, ...]:
    return tuple(names.get(variable, variable) for variable in variables)
