"""Other names for the variables of a body."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.rules import sparql
from kg.rules.decompose import expressions
from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    Element,
    EngineBlock,
    Exists,
    Expression,
    Filter,
    Values,
    Variable,
    mentions,
)
from kg.syntax import printer

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


def renamed(body: Iterable[Element], names: Mapping[Variable, Variable]) -> tuple[Element, ...]:
    """Return elements with other variables, those inside EXISTS, aggregates and text too."""
    return tuple(_renamed(element, names) for element in body) if names else tuple(body)


def everywhere(body: Iterable[Element]) -> frozenset[Variable]:
    """Return the variables at any depth, in aggregates too."""
    body = tuple(body)
    inner = [everywhere(element.body) for element in body if isinstance(element, Exists | Aggregate)]
    return frozenset().union(*inner, *map(mentions, body))


def _renamed(element: Element, names: Mapping[Variable, Variable]) -> Element:
    if isinstance(element, Atom):
        return element.replaced(names)
    if isinstance(element, Filter):
        return Filter(renamed_expression(element.expression, names))
    if isinstance(element, Assignment):
        return Assignment(_of(element.variable, names), renamed_expression(element.expression, names))
    if isinstance(element, Exists):
        return Exists(renamed(element.body, names), element.negated)
    if isinstance(element, Values):
        return Values(_all(element.variables, names), element.rows)
    if isinstance(element, EngineBlock):
        return _block(element, names)
    return _aggregate(element, names)


def renamed_expression(expression: Expression, names: Mapping[Variable, Variable]) -> Expression:
    """Return an expression with other variables."""
    spelt = _spelt(names)
    if spelt.keys().isdisjoint(expression.variables):
        return expression
    text = printer.renamed(expression.text, spelt)
    return replace(expression, text=text, variables=expressions.variables(text))


def _block(element: EngineBlock, names: Mapping[Variable, Variable]) -> EngineBlock:
    return replace(
        element,
        text=printer.renamed(element.text, _spelt(names)),
        variables=_all(element.variables, names),
        optional=_all(element.optional, names),
    )


def _aggregate(element: Aggregate, names: Mapping[Variable, Variable]) -> Aggregate:
    columns = tuple(
        replace(
            column,
            variable=_of(column.variable, names),
            expression=column.expression and renamed_expression(column.expression, names),
        )
        for column in element.columns
    )
    return Aggregate(_all(element.keys, names), columns, renamed(element.body, names))


def _spelt(names: Mapping[Variable, Variable]) -> dict[str, str]:
    return {sparql.spelling(old)[1:]: sparql.spelling(new)[1:] for old, new in names.items()}


def _of(variable: Variable, names: Mapping[Variable, Variable]) -> Variable:
    return names.get(variable, variable)


def _all(variables: tuple[Variable, ...], names: Mapping[Variable, Variable]) -> tuple[Variable, ...]:
    return tuple(_of(variable, names) for variable in variables)
