"""Sub-SELECTs: inlined with new names for what they hide, or as an aggregate.

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
from typing import TYPE_CHECKING

from kg.rules.decompose import expressions
from kg.rules.decompose.parts import EMPTY, IndivisibleError, Part, Scope
from kg.rules.decompose.renaming import renamed
from kg.rules.decompose.uses import possible
from kg.rules.form import Aggregate, Assignment, Column, Expression, Filter, Variable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.rules.decompose.work import Work
    from kg.syntax import tree

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
