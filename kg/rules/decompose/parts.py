"""Bodies in the making: a group of SPARQL is a union of parts, each a body in which all is bound or nothing."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.rules import sparql
from kg.rules.decompose import expressions
from kg.rules.form import Aggregate, Assignment, Atom, EngineBlock, Filter, Variable
from kg.rules.scope import binds, bound_in

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.decompose.names import Names
    from kg.rules.form import Element, Expression

__all__ = ["EMPTY", "IndivisibleError", "Part", "Scope", "attached", "joined", "placed", "same"]


class IndivisibleError(Exception):
    """A group has no exact decomposition; one around it is left to the store's engine."""


@dataclass(frozen=True, slots=True)
class Part:
    """Elements in order.

    `nodes` are the variables whose value is certainly a subject or object in the graph, `subjects` those of them whose
    value is a subject, and so neither a literal nor a triple term. `given` are variables of the group that have their
    value from what is before the part, in which they are the end of a path of length zero.
    """

    elements: tuple[Element, ...] = ()
    nodes: frozenset[Variable] = frozenset()
    subjects: frozenset[Variable] = frozenset()
    given: frozenset[Variable] = frozenset()
    bound: frozenset[Variable] = field(default=frozenset(), compare=False)
    """The variables that solutions bind: those of the elements, and those given. Asked for at each step, so kept."""

    @classmethod
    def of(
        cls,
        elements: Iterable[Element],
        nodes: frozenset[Variable] = frozenset(),
        subjects: frozenset[Variable] = frozenset(),
        given: frozenset[Variable] = frozenset(),
    ) -> Part:
        """Return the part of some elements, with the knowledge of this part."""
        elements = tuple(elements)
        return cls(elements, nodes, subjects, given, bound_in(elements) | given)

    @property
    def always(self) -> frozenset[Variable]:
        """The variables that each solution binds: all but those that a block may leave open."""
        open_ends = [element.optional for element in self.elements if isinstance(element, EngineBlock)]
        return self.bound.difference(*open_ends)

    def then(self, *elements: Element) -> Part:
        """Return the part with more elements behind."""
        atoms = [element for element in elements if isinstance(element, Atom)]
        subjects = frozenset(atom.subject for atom in atoms if isinstance(atom.subject, Variable))
        objects = frozenset(atom.object for atom in atoms if isinstance(atom.object, Variable))
        nodes = self.nodes | subjects | objects
        bound = self.bound.union(*map(binds, elements))
        return Part((*self.elements, *elements), nodes, self.subjects | subjects, self.given, bound)

    def same_node(self, variable: Variable, other: Variable) -> Part:
        """Return the part, knowing that one variable has the value of another."""
        nodes = self.nodes | ({variable} if other in self.nodes else set())
        subjects = self.subjects | ({variable} if other in self.subjects else set())
        given = self.given | ({other} - self.bound)
        return replace(self, nodes=nodes, subjects=subjects, given=given, bound=self.bound | {other})


EMPTY: Final = Part()
"""One solution that binds nothing."""


@dataclass(frozen=True, slots=True)
class Scope:
    """Context of a group under decomposition.

    `outer`: variables bound around an EXISTS, which everything inside sees. `seen`: those that only the group's own
    filters see, for OPTIONAL. `near`: those that are subjects or objects in the graph and bound before the group where
    it will be; `subjects` those of them that are subjects. `required`: solutions without one of these come to
    nothing. `single`: it matters how often a solution comes.
    """

    outer: frozenset[Variable] = frozenset()
    seen: frozenset[Variable] = frozenset()
    near: frozenset[Variable] = frozenset()
    subjects: frozenset[Variable] = frozenset()
    required: frozenset[str] = frozenset()
    single: bool = False

    def behind(self, part: Part) -> Scope:
        """Return the scope of a group that is joined with `part`, which its filters do not see."""
        return replace(self, seen=frozenset(), near=self.near | part.nodes, subjects=self.subjects | part.subjects)

    def optional(self, part: Part) -> Scope:
        """Return the scope of the group of an OPTIONAL behind `part`: its own filters see what is before it."""
        return replace(self._kept(part, self.outer | part.bound), seen=part.bound, required=frozenset())

    def inside(self, part: Part) -> Scope:
        """Return the scope of the group of an EXISTS that is tested for each solution of `part`."""
        outer = self.outer | self.seen | part.bound
        kept = self._kept(part, outer)
        return Scope(outer, near=kept.near, subjects=kept.subjects)

    def removing(self, part: Part) -> Scope:
        """Return the scope of the group of a MINUS behind `part`: it sees nothing of it."""
        kept = self._kept(part, self.outer | part.bound)
        return Scope(self.outer, near=kept.near, subjects=kept.subjects)

    def _kept(self, part: Part, shared: frozenset[Variable]) -> Scope:
        """Return what is known after `part` of the variables that a negation there shares with its surroundings."""
        behind = self.behind(part)
        return replace(behind, near=behind.near & shared, subjects=behind.subjects & shared)


def joined(left: Part, right: Part, names: Names) -> Part:
    """Return the join of two parts that know nothing of each other.

    Putting the elements of one behind those of the other is exact, for each tests and binds by its own variables,
    which `attached` sees to.
    """
    elements = (*left.elements, *attached(right.elements, left.bound, names))
    return Part.of(elements, left.nodes | right.nodes, left.subjects | right.subjects, left.given | right.given)


def attached(elements: Iterable[Element], bound: frozenset[Variable], names: Names) -> Iterator[Element]:
    """Yield elements as they are after `bound` is bound: an assignment to a bound variable becomes a comparison.

    SPARQL joins solutions whose terms are the same, so `sameTerm` is the comparison. The expression compared is in
    error where the assignment is, and both take the solution away.
    """
    for element in elements:
        if isinstance(element, Assignment) and element.variable in bound:
            yield Filter(same(element.variable, element.expression))
        elif isinstance(element, Aggregate):
            yield from _grouped(element, bound, names)
        else:
            yield element
        bound |= binds(element)


def _grouped(element: Aggregate, bound: frozenset[Variable], names: Names) -> Iterator[Element]:
    new = {column.variable: names.like(column.variable) for column in element.columns if column.variable in bound}
    columns = tuple(replace(column, variable=new.get(column.variable, column.variable)) for column in element.columns)
    yield replace(element, columns=columns)
    for old, fresh in new.items():
        yield Filter(same(old, expressions.expression(sparql.spelling(fresh))))


def same(variable: Variable, expression: Expression) -> Expression:
    """Return the test that a variable is the value of an expression."""
    text = f"sameTerm({sparql.spelling(variable)}, {expression.text})"
    return expressions.expression(text, expression.place)


def placed(part: Part, element: Filter, known: frozenset[Variable]) -> Part:
    """Put a filter right behind what binds its variables; `known` are bound before the part.

    Elements only join, bind or drop solutions one by one, so a filter does the same anywhere behind that.
    """
    needed = frozenset(map(Variable, element.expression.variables)) - known
    elements = part.elements
    if needed and not element.expression.volatile:
        for index, before in enumerate(elements[:-1], 1):
            needed -= binds(before)
            if not needed:
                return replace(part, elements=(*elements[:index], element, *elements[index:]))
    return replace(part, elements=(*elements, element))
