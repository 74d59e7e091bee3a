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

Sub-SELECTs:

* Without aggregates, a sub-SELECT gives its group's solutions cut to its columns. Giving the variables that it cuts
  away names that nothing else has keeps the set of solutions of whatever it is joined with, and how often they come.
* An aggregate counts solutions, so its group has to be one part in which no solution comes twice: a body's solutions
  differ in some variable, those of blank nodes counted.
* An aggregate or an expression in error leaves its column unbound. That is exact where nothing comes of a solution
  without the column; otherwise the store's engine evaluates the sub-SELECT.
* HAVING tests what the aggregates gave; an error there takes the solution away, as in any filter.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.rules import sparql
from kg.rules.decompose import expressions
from kg.rules.decompose.blocks import block
from kg.rules.decompose.parts import EMPTY, IndivisibleError, Part, Scope, attached, joined, placed
from kg.rules.decompose.patterns import basic
from kg.rules.decompose.renaming import certain, everywhere, possible, renamed, uses
from kg.rules.form import Aggregate, Assignment, Column, Element, Exists, Expression, Filter, Term, Values, Variable
from kg.syntax import tree

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kg.rules.decompose.parts import Work

    Decompose = Callable[[tree.Group, Scope], list[Part]]

_NEVER_FAIL_ON_TERMS = frozenset({"MIN", "MAX", "SAMPLE"})


def selected(work: Work, node: tree.SubSelect, scope: Scope, group: Decompose) -> list[Part]:
    """Return the parts of a sub-SELECT; `group` decomposes its group."""
    if node.sliced or (scope.single and node.distinct):
        raise IndivisibleError
    if node.keys or node.having or any(c.expression and c.expression.aggregates for c in node.projections):
        return [_grouped(work, node, scope, group)]
    return _plain(work, node, scope, group)


def _plain(work: Work, node: tree.SubSelect, scope: Scope, group: Decompose) -> list[Part]:
    shown = _columns(node)
    visible = frozenset(map(Variable, shown))
    inner = replace(
        scope,
        outer=scope.outer & visible,
        near=scope.near & visible,
        subjects=scope.subjects & visible,
        required=scope.required & shown,
    )
    parts = group(node.group, inner)
    for column in node.projections:
        if value := column.expression:
            if parts and (value.exists or column.variable in inner.outer):
                raise IndivisibleError
            parts = [
                part.then(_assignment(work, node, column.variable, value, value.text, part, inner)) for part in parts
            ]
    return [_hiding(work, part, visible) for part in parts]


def _columns(node: tree.SubSelect) -> frozenset[str]:
    if not node.projections:
        return possible(node.group.nodes)
    return frozenset(column.variable.name for column in node.projections)


def _assignment(  # noqa: PLR0913, PLR0917 - what is assigned, in which column of what, behind what
    work: Work,
    node: tree.SubSelect,
    variable: Variable,
    value: tree.Expression,
    text: str,
    part: Part,
    scope: Scope,
) -> Assignment:
    resolved = expressions.resolved(text, {bound.name for bound in part.bound})
    if resolved is None or (expressions.can_fail(resolved) and not _needed(work, node, variable, scope)):
        raise IndivisibleError
    return Assignment(variable, expressions.expression(resolved, work.place(value.span)))


def _needed(work: Work, node: tree.SubSelect, variable: Variable, scope: Scope) -> bool:
    """Return whether a solution without a column of a sub-SELECT derives nothing."""
    return variable.name in scope.required and not work.bound_elsewhere(variable.name, node)


def _hiding(work: Work, part: Part, visible: Iterable[Variable]) -> Part:
    """Return a part with new names for what is not visible; variables that the rule does not write have their own."""
    hidden = sorted(part.bound - frozenset(visible), key=str)
    written = (one for one in hidden if not one.name.startswith(".") and one.name in work.mentioned)
    names = {variable: work.names.like(variable) for variable in written}
    groups = (part.nodes, part.subjects, part.given)
    nodes, subjects, given = (frozenset(names.get(variable, variable) for variable in group) for group in groups)
    return Part.of(renamed(part.elements, names), nodes, subjects, given)


@dataclass(slots=True)
class _Grouping:
    """The columns of an aggregate as they are found in expressions."""

    work: Work
    body: Part
    grouped: bool
    columns: list[Column] = field(default_factory=list)
    can_fail: bool = False
    """Whether a column of the expression read last may be in error."""

    def replaced(self, value: tree.Expression, own: Variable | None = None) -> str:
        """Return an expression with a variable for each aggregate; `own` for one that is all of it."""
        text, self.can_fail = value.text, False
        for call in value.aggregates:
            whole = call.text == value.text and own is not None
            variable = own if whole and own else self.work.names.like(Variable(call.function.lower()))
            self.columns.append(self._column(variable, call))
            text = text.replace(call.text, f"?{variable.name}", 1)
        return text

    def _column(self, variable: Variable, call: tree.AggregateCall) -> Column:
        argument = self._argument(call)
        simple = argument is not None and not expressions.can_fail(argument.text)
        safe = call.function == "COUNT" or (call.function in _NEVER_FAIL_ON_TERMS and simple and self.grouped)
        self.can_fail |= not safe
        distinct = call.distinct and argument is not None
        return Column(variable, call.function, argument, distinct, call.separator)

    def _argument(self, call: tree.AggregateCall) -> Expression | None:
        if call.argument is None:
            if call.distinct and any(variable.name.startswith(".") for variable in self.body.bound):
                # COUNT(DISTINCT *) counts without blank nodes; without any, the solutions are distinct already.
                raise IndivisibleError
            return None
        bound = {variable.name for variable in self.body.bound}
        if call.argument.exists or not set(call.argument.variables) <= bound:
            raise IndivisibleError
        return expressions.expression(call.argument.text, self.work.place(call.argument.span))


def _grouped(work: Work, node: tree.SubSelect, scope: Scope, group: Decompose) -> Part:
    keys = tuple(dict.fromkeys(key.variable for key in node.keys))
    (body,) = group(node.group, Scope(single=True))
    if any(key.expression for key in node.keys) or not body.always.issuperset(keys):
        raise IndivisibleError
    grouping = _Grouping(work, body, bool(keys))
    tests = [_having(grouping, condition, keys) for condition in node.having]
    assigned = [bound for column in node.projections if (bound := _value(work, node, grouping, column, scope))]
    names = {key: work.names.like(key) for key in keys if key.name not in _columns(node)}
    element = Aggregate(keys, tuple(grouping.columns), body.elements)
    part = EMPTY.then(element, *tests)
    for variable, value, text in assigned:
        part = part.then(_assignment(work, node, variable, value, text, part, scope))
    return _hiding(work, Part.of(renamed(part.elements, names)), map(Variable, _columns(node)))


def _having(grouping: _Grouping, condition: tree.Expression, keys: tuple[Variable, ...]) -> Filter:
    text = grouping.replaced(condition)
    visible = {variable.name for variable in (*keys, *(column.variable for column in grouping.columns))}
    unclear = grouping.can_fail and not expressions.is_strict(text)
    if condition.exists or unclear or not set(expressions.variables(text)) <= visible:
        raise IndivisibleError
    return Filter(expressions.expression(text, grouping.work.place(condition.span)))


def _value(
    work: Work, node: tree.SubSelect, grouping: _Grouping, column: tree.Projection, scope: Scope
) -> tuple[Variable, tree.Expression, str] | None:
    """Return what a column assigns behind the aggregate; None if it is a key or an aggregate itself."""
    value = column.expression
    if value is None:
        return None
    if value.exists:
        raise IndivisibleError
    text = grouping.replaced(value, column.variable)
    if grouping.can_fail and not _needed(work, node, column.variable, scope):
        raise IndivisibleError
    return None if text == f"?{column.variable.name}" else (column.variable, value, text)


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
