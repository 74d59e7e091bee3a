"""Groups of SPARQL as unions of bodies (SPARQL 1.1, section 18.2: what a group means; section 18.5: its operators).

Each rewriting keeps the set of solutions:

* UNION: a union of joins is a join with the union, so each branch becomes a part of its own.
* A group in braces is evaluated by itself and joined. Its variables that it does not bind are unbound in its filters,
  whatever is bound outside: `expressions.resolved` rewrites the expression accordingly.
* OPTIONAL {G}: the solutions joined with G where its filters hold, and those for which there is no such join. The
  second part leaves out its negation where what only G binds is mentioned nowhere but in the head: a solution that
  does have a match then derives triples of the head that the first part derives too.
* MINUS {G}: no solution of G that agrees on the shared variables; without shared variables nothing is removed.
* FILTER EXISTS {G}: a test for each solution, which everything in G sees.
* FILTER: tests the whole group, wherever it is written, so it is placed after what binds its variables.
* BIND: the solutions in which the expression has a value; and those in which it is in error, with the variable
  unbound, left out where solutions without the variable derive nothing.
* VALUES: a join with rows; rows with UNDEF at the same places are a table of their own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.rules import sparql
from kg.rules.decompose import expressions
from kg.rules.decompose.blocks import block
from kg.rules.decompose.parts import EMPTY, IndivisibleError, Part, Scope, attached, joined, placed
from kg.rules.decompose.patterns import basic
from kg.rules.decompose.renaming import everywhere, renamed
from kg.rules.decompose.selects import selected
from kg.rules.decompose.uses import certain, uses
from kg.rules.form import Assignment, Element, Exists, Filter, Term, Values, Variable
from kg.syntax import tree

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.decompose.work import Work

MOST_PARTS: Final = 64
"""With more parts than this, the store's engine evaluates the rule as written."""


@dataclass(frozen=True, slots=True)
class Condition:
    """An expression, or an EXISTS; `requires` are the names without which it is never true."""

    text: str
    span: tree.Span
    exists: tree.Exists | None = None

    @property
    def requires(self) -> tuple[str, ...]:
        """An unbound variable is an error in an expression that has nothing to forgive it; BOUND asks for one."""
        if self.exists is not None:
            return ()
        names = expressions.variables(self.text)
        return names if expressions.is_strict(self.text) or expressions.simplified(self.text, names) == "true" else ()


def conditions(node: tree.Filter | tree.Exists) -> Iterator[Condition]:
    """Yield the conditions of a filter; IndivisibleError where an EXISTS is inside a larger expression."""
    if isinstance(node, tree.Exists):
        yield Condition("", node.span, node)
        return
    tests = iter(node.expression.exists)
    for text in expressions.conjuncts(node.expression.text):
        try:
            turned = expressions.existence(text)
        except ValueError:
            raise IndivisibleError from None
        if turned is None:
            yield Condition(text, node.span)
        else:
            test = next(tests)
            yield Condition("", test.span, replace(test, negated=test.negated ^ turned))


class Groups:
    """Decomposes the groups of one rule; IndivisibleError where that is not exact."""

    def __init__(self, work: Work) -> None:
        self._work = work

    def group(self, group: tree.Group, scope: Scope) -> list[Part]:
        """Return the parts of a group evaluated by itself."""
        filters = [node for node in group.nodes if isinstance(node, tree.Filter | tree.Exists)]
        tests = [test for node in filters for test in conditions(node)]
        strict = [name for test in tests for name in test.requires]
        scope = replace(scope, required=scope.required.union(strict))
        parts = [replace(EMPTY, nodes=scope.near, subjects=scope.subjects)]
        together: list[tree.TriplePattern] = []
        for node in group.nodes:
            if isinstance(node, tree.TriplePattern):
                together.append(node)
            elif node not in filters:
                parts = self._counted(self._triples(together, parts, scope), scope)
                together = []
                parts = self._counted([new for part in parts for new in self._node(node, part, scope)], scope)
        parts = self._triples(together, parts, scope)
        for test in tests:
            parts = [new for part in parts for new in self._tested(part, test, scope)]
        return self._counted(parts, scope)

    def _triples(self, patterns: list[tree.TriplePattern], parts: list[Part], scope: Scope) -> list[Part]:
        return [new for part in parts for new in basic(self._work, patterns, part, scope)]

    def _counted(self, parts: list[Part], scope: Scope) -> list[Part]:
        """Return the parts without duplicates; IndivisibleError for too many."""
        parts = list(dict.fromkeys(parts))
        if len(parts) > MOST_PARTS or (scope.single and len(parts) != 1):
            raise IndivisibleError
        return parts

    def _node(self, node: tree.Node, part: Part, scope: Scope) -> Iterator[Part]:
        if isinstance(node, tree.Union):
            for group in node.groups:
                for branch in self.group(group, scope.behind(part)):
                    yield joined(part, branch, self._work.names)
        elif isinstance(node, tree.Optional):
            yield from self._optional(node, part, scope)
        elif isinstance(node, tree.Minus):
            yield self._minus(node, part, scope)
        elif isinstance(node, tree.Bind):
            yield from self._bind(node, part, scope)
        elif isinstance(node, tree.ValuesBlock):
            yield from self._values(node, part, scope)
        elif isinstance(node, tree.SubSelect):
            yield from self._select(node, part, scope)
        elif isinstance(node, tree.GraphBlock):
            yield self._blocked(node, f"GRAPH {sparql.term(node.name)} {node.group.text}", part, scope)

    def _optional(self, node: tree.Optional, part: Part, scope: Scope) -> Iterator[Part]:
        bound = part.bound
        matches = self.group(node.group, scope.optional(part))
        new = frozenset(variable.name for match in matches for variable in match.bound - bound)
        plain = not scope.single and not self._work.mints_blanks and not self._work.used_elsewhere(new, node)
        if not plain or new & self._work.template:
            for match in matches:
                yield joined(part, match, self._work.names)
        if self._comes_to_nothing(new, node, scope):
            return
        if plain:
            yield part
            return
        if rest := self._without(part, matches, bound | scope.outer, node):
            yield rest

    def _comes_to_nothing(self, names: frozenset[str], node: tree.Node, scope: Scope) -> bool:
        """Return whether solutions without a value for one of these names derive nothing."""
        return any(not self._work.bound_elsewhere(name, node) for name in names & scope.required)

    def _without(self, part: Part, matches: list[Part], shared: frozenset[Variable], node: tree.Node) -> Part | None:
        """Return the part without the solutions that agree with one of `matches`; None if none are left."""
        for match in matches:
            if not match.elements:
                return None
            part = part.then(Exists(self._inner(match, shared, node), negated=True))
        return part

    def _inner(self, match: Part, shared: frozenset[Variable], node: tree.Node) -> tuple[Element, ...]:
        """Return the body of an EXISTS for a node, with its own variables renamed apart."""
        elements = tuple(attached(match.elements, shared, self._work.names))
        own = sorted((v for v in everywhere(elements) - shared if self._work.mentioned[v.name]), key=str)
        names = {v: self._work.names.like(v) for v in own if self._work.used_elsewhere(frozenset((v.name,)), node)}
        return renamed(elements, names)

    def _minus(self, node: tree.Minus, part: Part, scope: Scope) -> Part:
        bound = part.bound
        removed = []
        for match in self.group(node.group, scope.removing(part)):
            if match.bound & bound:
                removed.append(match)
            elif match.bound & scope.outer:
                # With variables from an EXISTS around, engines disagree on what is shared.
                raise IndivisibleError
        return self._without(part, removed, bound | scope.outer, node) or part

    def _bind(self, node: tree.Bind, part: Part, scope: Scope) -> Iterator[Part]:
        if node.expression.exists or node.variable in scope.outer:
            raise IndivisibleError
        name = node.variable.name
        visible = {variable.name for variable in part.bound | scope.outer}
        text = expressions.resolved(node.expression.text, visible)
        place = self._work.place(node.expression.span)
        if text is not None:
            value = expressions.expression(text, place)
            mints = expressions.expression(node.expression.text).mints
            yield part.then(Assignment(node.variable, replace(value, mints=mints)))
        if text is not None and not expressions.can_fail(text):
            return
        if self._comes_to_nothing(frozenset((name,)), node, scope):
            return
        used = scope.single or self._work.mints_blanks or self._work.used_elsewhere(frozenset((name,)), node)
        if text is None or not used:
            yield part
        else:
            yield part.then(Filter(expressions.expression(expressions.fails(text), place)))

    def _values(self, node: tree.ValuesBlock, part: Part, scope: Scope) -> Iterator[Part]:
        if scope.single and len(set(node.rows)) < len(node.rows):
            raise IndivisibleError
        tables: dict[tuple[int, ...], list[tuple[Term | None, ...]]] = {}
        for row in dict.fromkeys(node.rows):
            tables.setdefault(tuple(i for i, cell in enumerate(row) if cell is not None), []).append(row)
        for columns, rows in tables.items():
            variables = tuple(node.variables[index] for index in columns)
            cells = tuple(tuple(cell for cell in row if cell is not None) for row in rows)
            yield part.then(Values(variables, cells)) if variables else part

    def _select(self, node: tree.SubSelect, part: Part, scope: Scope) -> Iterator[Part]:
        try:
            for inner in selected(self._work, node, scope.behind(part), self.group):
                yield joined(part, inner, self._work.names)
        except IndivisibleError:
            if scope.single and not node.distinct:
                raise
            yield self._blocked(node, f"{{ {node.text} }}", part, scope)

    def _blocked(self, node: tree.Node, text: str, part: Part, scope: Scope) -> Part:
        """Return a node as a block for the store's engine, evaluated by itself as in SPARQL outside of EXISTS."""
        inner = uses([node]).keys() - certain([node])
        if scope.single and not isinstance(node, tree.SubSelect):
            raise IndivisibleError
        if inner & {variable.name for variable in scope.outer}:
            raise IndivisibleError
        return part.then(block(text, (node,), self._work.place(node.span)))

    def _tested(self, part: Part, test: Condition, scope: Scope) -> list[Part]:
        """Return a part with a filter of its group, as any number of parts."""
        if test.exists is not None:
            return self._exists(part, test.exists, scope)
        around = scope.outer | scope.seen
        text = expressions.resolved(test.text, {variable.name for variable in part.bound | around})
        text = text and expressions.simplified(text, {variable.name for variable in part.always})
        if text == "true":
            return [part]
        if text is None or text == "false":
            return []
        return [placed(part, Filter(expressions.expression(text, self._work.place(test.span))), around)]

    def _exists(self, part: Part, node: tree.Exists, scope: Scope) -> list[Part]:
        inner = scope.inside(part)
        matches = self.group(node.group, inner)
        if node.negated:
            rest = self._without(part, matches, inner.outer, node)
            return [rest] if rest else []
        if any(not match.elements for match in matches):
            return [part]
        return [part.then(Exists(self._inner(match, inner.outer, node))) for match in matches]
