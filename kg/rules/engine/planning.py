"""Prepares rules: resolves the meaning of a body's order. Its steps may then run in any order.

* A filter or an assignment sees the variables bound before it in the text, and no others.
* A positive EXISTS becomes part of the body, its own variables renamed; a solution stays one solution, since what
  only the EXISTS binds reaches neither head nor blank nodes. Bodies that are counted keep theirs apart.
* A triple term with variables becomes a variable and a step that takes it apart.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from pyoxigraph import BlankNode

from kg.rules.engine.plan import (
    Assign,
    Block,
    Body,
    Fresh,
    Grouped,
    Head,
    HeadNode,
    Match,
    Nested,
    Node,
    Rows,
    RulePlan,
    Source,
    Step,
    Structure,
    Test,
    binds,
)
from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    Element,
    EngineBlock,
    Exists,
    Expression,
    Filter,
    Pattern,
    Rule,
    TripleTerm,
    Values,
    Variable,
    variables_of,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.engine.terms import Dictionary


def plan(rule: Rule, dictionary: Dictionary) -> RulePlan:
    """Prepare a rule; interns its constants."""
    planner = _Planner(dictionary)
    outermost = _Within({})
    steps = planner.steps(rule.body, outermost)
    scope = outermost.scope
    heads = tuple(Head(*(planner.head_node(pattern, scope) for pattern in atom.positions)) for atom in rule.head)
    fresh = any(_mints(node) for head in heads for node in head.nodes)
    solution = tuple(sorted(scope.items())) if fresh else ()
    needed = {name for head in heads for node in head.nodes for name in _columns(node)}
    outputs = frozenset(needed | {column for _, column in solution})
    resources: set[HeadNode] = {node for head in heads for node in head.nodes if isinstance(node, Fresh)}
    resources |= {step.subject for step in steps if isinstance(step, Match) and isinstance(step.subject, str)}
    return RulePlan(rule, _body(steps), heads, tuple(planner.sources), solution, outputs, frozenset(resources))


def _mints(node: HeadNode) -> bool:
    return isinstance(node, Fresh) or (isinstance(node, tuple) and any(_mints(part) for part in node))


def _columns(node: HeadNode) -> list[str]:
    if isinstance(node, tuple):
        return [name for part in node for name in _columns(part)]
    return [node] if isinstance(node, str) else []


def _body(steps: Sequence[Step]) -> Body:
    """Return a body of steps with the properties of all of them."""
    numbers: set[int] = set()
    for step in steps:
        if isinstance(step, Match | Block):
            numbers.add(step.number)
        elif isinstance(step, Nested | Grouped):
            numbers |= step.body.numbers
    return Body(tuple(steps), frozenset(numbers), frozenset[str]().union(*map(binds, steps)))


@dataclass(frozen=True, slots=True)
class _Within:
    """Where a step stands. `scope`: the columns of the variables bound so far; it grows.

    Columns of an `inner` body get new names; a `bag` counts its solutions; `positive`: more matches only add
    solutions; `element` is the number of the outermost element around, None outside of any.
    """

    scope: dict[str, str]
    inner: bool = False
    bag: bool = False
    positive: bool = True
    element: int | None = None


class _Planner:
    """Numbers sources and names columns over one rule."""

    def __init__(self, dictionary: Dictionary) -> None:
        self._dictionary = dictionary
        self._fresh = 0
        self.sources: list[Source] = []

    def steps(self, body: Sequence[Element], within: _Within) -> list[Step]:
        """Return the steps of a body; `within.scope` has what they bind afterwards."""
        result: list[Step] = []
        for index, part in enumerate(body):
            here = within if within.element is not None else replace(within, element=index)
            element = here.element or 0
            if isinstance(part, Atom):
                result += self._atom(part, here, element)
            elif isinstance(part, Exists) and not part.negated and not within.bag:
                result += self.steps(part.body, replace(here, scope=dict(here.scope), inner=True))
            elif isinstance(part, Exists):
                result.append(self._nested(part, here, element))
            elif isinstance(part, Filter):
                result.append(Test(part.expression, _seen(part.expression, here.scope), element))
            elif isinstance(part, Assignment):
                seen = _seen(part.expression, here.scope)
                result.append(Assign(self._name(part.variable, here), part.expression, seen, element))
            elif isinstance(part, Values):
                result.append(self._rows(part, here, element))
            elif isinstance(part, Aggregate):
                result.append(self._grouped(part, here, element))
            else:
                result.append(self._block(part, here, element))
        return result

    def _name(self, variable: Variable, within: _Within) -> str:
        """Return the column of a variable, a new one when it is not bound yet."""
        name, scope = variable.name, within.scope
        if name not in scope:
            self._fresh += 1
            scope[name] = f"{name}/{self._fresh}" if within.inner else name
        return scope[name]

    def _node(self, pattern: Pattern, within: _Within, element: int, structures: list[Structure]) -> Node:
        if isinstance(pattern, Variable):
            return self._name(pattern, within)
        if not isinstance(pattern, TripleTerm):
            return self._dictionary.intern_term(pattern)
        self._fresh += 1
        name = f"/{self._fresh}"
        subject = self._node(pattern.subject, within, element, structures)
        predicate = self._node(pattern.predicate, within, element, structures)
        value = self._node(pattern.object, within, element, structures)
        structures.append(Structure(name, (subject, predicate, value), element))
        return name

    def _atom(self, atom: Atom, within: _Within, element: int) -> list[Step]:
        structures: list[Structure] = []
        nodes = [self._node(pattern, within, element, structures) for pattern in atom.positions]
        self.sources.append(Source(atom, within.positive))
        return [Match(len(self.sources) - 1, nodes[0], nodes[1], nodes[2], element), *reversed(structures)]

    def _rows(self, values: Values, within: _Within, element: int) -> Rows:
        names = [self._name(variable, within) for variable in values.variables]
        table = np.array([[self._dictionary.intern_term(term) for term in row] for row in values.rows], np.int64)
        table = table.reshape(len(values.rows), len(names))
        columns = tuple((name, table[:, index].copy()) for index, name in enumerate(names))
        return Rows(frozenset(names), columns, len(values.rows), element)

    def _nested(self, exists: Exists, within: _Within, element: int) -> Nested:
        mentioned = _mentioned(exists.body)
        shared = frozenset(column for name, column in within.scope.items() if name in mentioned)
        inside = _Within(dict(within.scope), inner=True, positive=False, element=element)
        return Nested(_body(self.steps(exists.body, inside)), exists.negated, shared, element)

    def _grouped(self, aggregate: Aggregate, within: _Within, element: int) -> Grouped:
        inside = _Within({}, inner=True, bag=True, positive=False, element=element)
        body = _body(self.steps(aggregate.body, inside))
        keys = tuple((inside.scope[key.name], self._name(key, within)) for key in aggregate.keys)
        columns = tuple((column, self._name(column.variable, within)) for column in aggregate.columns)
        return Grouped(body, keys, columns, tuple(inside.scope.items()), element)

    def _block(self, block: EngineBlock, within: _Within, element: int) -> Block:
        self.sources.append(Source(block, within.positive and block.monotone))
        columns = tuple((variable.name, self._name(variable, within)) for variable in block.variables)
        return Block(len(self.sources) - 1, block, columns, element)

    def head_node(self, pattern: Pattern, scope: dict[str, str]) -> HeadNode:
        """Return the node at a position of the head."""
        if isinstance(pattern, Variable):
            return scope[pattern.name]
        if isinstance(pattern, BlankNode):
            return Fresh(pattern.value)
        if isinstance(pattern, TripleTerm):
            return (
                self.head_node(pattern.subject, scope),
                self.head_node(pattern.predicate, scope),
                self.head_node(pattern.object, scope),
            )
        return self._dictionary.intern_term(pattern)


def _seen(expression: Expression, scope: dict[str, str]) -> tuple[tuple[str, str], ...]:
    return tuple((name, scope[name]) for name in expression.variables if name in scope)


def _mentioned(body: Sequence[Element]) -> set[str]:
    """Return the names of the variables that a body mentions, inner bodies of EXISTS too."""
    names: set[str] = set()
    for part in body:
        if isinstance(part, Atom):
            names |= {variable.name for position in part.positions for variable in variables_of(position)}
        elif isinstance(part, Filter | Assignment):
            names |= set(part.expression.variables)
        elif isinstance(part, Exists):
            names |= _mentioned(part.body)
        elif isinstance(part, Values | EngineBlock):
            names |= {variable.name for variable in part.variables}
        else:
            names |= {key.name for key in part.keys} | {column.variable.name for column in part.columns}
        if isinstance(part, Assignment):
            names.add(part.variable.name)
    return names
