"""Other names for the variables of a body."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from kg.rules import form, sparql
from kg.rules.decompose import expressions
from kg.syntax import printer


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
