"""Parts of bodies: a group of SPARQL becomes a union of parts, each of which binds all of its variables or none."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import chain
from typing import TYPE_CHECKING, Final

from kg.rules import form, sparql
from kg.rules.decompose import expressions
from kg.rules.decompose.renaming import Uses, uses
from kg.rules.form import Atom, Element, Variable, has_blank, variables_of
from kg.syntax.lexer import normalise
from kg.syntax.position import place_at

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.errors import Place
    from kg.syntax.tree import Node, RuleText, Span, TriplePattern

AuxiliaryRules = dict[str, list[tuple["tuple[Atom]", "tuple[Element, ...]"]]]
"""The IRI of a predicate to the heads and bodies that derive it."""


class Names:
    """Gives new variables; `taken` are the names that the rule has, blank nodes' with their `.`."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)

    def hidden(self) -> Variable:
        """Return a variable that no expression and no text will mention: its name begins with `.`."""
        return self._first(".{}")

    def like(self, variable: Variable) -> Variable:
        """Return a variable that SPARQL can write, named after another."""
        return self._first(variable.name.lstrip(".").partition("·")[0] + "·{}")

    def _first(self, form: str) -> Variable:
        number = 1
        while (name := form.format(number)) in self._taken:
            number += 1
        self._taken.add(name)
        return Variable(name)


@dataclass(slots=True)
class Work:
    """One rule: its text, the names that are taken, and the auxiliary rules that its paths need."""

    rule: RuleText
    text: str
    path: str
    auxiliary: AuxiliaryRules = field(default_factory=dict)
    written: str = field(init=False)
    names: Names = field(init=False)
    mentioned: Uses = field(init=False)
    binding: Uses = field(init=False)
    template: frozenset[str] = field(init=False)
    mints_blanks: bool = field(init=False)

    def __post_init__(self) -> None:
        """Count the occurrences of names."""
        self.written = normalise(self.text)
        self.mentioned = uses(self.rule.group.nodes)
        self.binding = uses(self.rule.group.nodes, binding=True)
        self.template = frozenset(chain.from_iterable(map(head_variables, self.rule.template)))
        self.mints_blanks = any(
            has_blank(end) for triple in self.rule.template for end in (triple.subject, triple.object)
        )
        self.names = Names({*self.mentioned, *self.template})

    def place(self, span: Span) -> Place:
        """Return where something begins."""
        return place_at(self.written, span.start, self.path)

    def used_elsewhere(self, names: frozenset[str], node: Node) -> bool:
        """Return whether the pattern mentions one of the variables outside of a node."""
        within = uses([node])
        return any(self.mentioned[name] > within[name] for name in names)

    def bound_elsewhere(self, name: str, node: Node) -> bool:
        """Return whether something outside of a node may bind a variable."""
        return self.binding[name] > uses([node], binding=True)[name]


def head_variables(triple: TriplePattern) -> frozenset[str]:
    """Return the names of the variables in a triple of a template."""
    positions = (triple.subject, triple.predicate, triple.object)
    return frozenset(variable.name for position in positions for variable in variables_of(position))  # type: ignore[arg-type]  # a template has no paths


class IndivisibleError(Exception):
    """A group has no exact decomposition; the store's engine evaluates a group around it."""


@dataclass(frozen=True, slots=True)
class Part:
    """Elements in order.

    `nodes` are the variables whose value is certainly a subject or object in the graph, `subjects` those of them whose
    value is a subject, and so neither a literal nor a triple term. `given` are variables of the group that have their
    value from what is before the part, in which they are the end of a path of length zero.
    """

    elements: tuple[form.Element, ...] = ()
    nodes: frozenset[form.Variable] = frozenset()
    subjects: frozenset[form.Variable] = frozenset()
    given: frozenset[form.Variable] = frozenset()
    bound: frozenset[form.Variable] = field(default=frozenset(), compare=False)
    """The variables that solutions bind: those of the elements, and `given`. Cached, since each step reads it."""

    @classmethod
    def of(
        cls,
        elements: Iterable[form.Element],
        nodes: frozenset[form.Variable] = frozenset(),
        subjects: frozenset[form.Variable] = frozenset(),
        given: frozenset[form.Variable] = frozenset(),
    ) -> Part:
        """Return a part with other elements and the same properties."""
        elements = tuple(elements)
        return cls(elements, nodes, subjects, given, form.bound_in(elements) | given)

    @property
    def always(self) -> frozenset[form.Variable]:
        """The variables that each solution binds: all but those that a block may leave open."""
        open_ends = [element.optional for element in self.elements if isinstance(element, form.EngineBlock)]
        return self.bound.difference(*open_ends)

    def then(self, *elements: form.Element) -> Part:
        """Return the part with more elements at its end."""
        atoms = [element for element in elements if isinstance(element, form.Atom)]
        subjects = frozenset(atom.subject for atom in atoms if isinstance(atom.subject, form.Variable))
        objects = frozenset(atom.object for atom in atoms if isinstance(atom.object, form.Variable))
        nodes = self.nodes | subjects | objects
        bound = self.bound.union(*map(form.binds, elements))
        return Part((*self.elements, *elements), nodes, self.subjects | subjects, self.given, bound)

    def same_node(self, variable: form.Variable, other: form.Variable) -> Part:
        """Return the part, given that two variables have the same value."""
        nodes = self.nodes | ({variable} if other in self.nodes else set())
        subjects = self.subjects | ({variable} if other in self.subjects else set())
        given = self.given | ({other} - self.bound)
        return replace(self, nodes=nodes, subjects=subjects, given=given, bound=self.bound | {other})


EMPTY: Final = Part()
"""One solution that binds nothing."""


@dataclass(frozen=True, slots=True)
class Scope:
    """Context of a group under decomposition.

    `outer`: variables bound around an EXISTS, visible everywhere inside. `seen`: variables visible only to the filters
    of the group itself, for OPTIONAL. `near`: subjects or objects of the graph that are bound before the group;
    `subjects`: those of them that are subjects. `required`: solutions without one of these derive nothing. `single`:
    whether the number of equal solutions matters.
    """

    outer: frozenset[form.Variable] = frozenset()
    seen: frozenset[form.Variable] = frozenset()
    near: frozenset[form.Variable] = frozenset()
    subjects: frozenset[form.Variable] = frozenset()
    required: frozenset[str] = frozenset()
    single: bool = False

    def behind(self, part: Part) -> Scope:
        """Return the scope of a group joined with `part`; its filters do not see the variables of `part`."""
        return replace(self, seen=frozenset(), near=self.near | part.nodes, subjects=self.subjects | part.subjects)

    def optional(self, part: Part) -> Scope:
        """Return the scope of the group of an OPTIONAL after `part`: its own filters see the variables of `part`."""
        return replace(self._limited(part, self.outer | part.bound), seen=part.bound, required=frozenset())

    def inside(self, part: Part) -> Scope:
        """Return the scope of the group of an EXISTS that is tested for each solution of `part`."""
        outer = self.outer | self.seen | part.bound
        limited = self._limited(part, outer)
        return Scope(outer, near=limited.near, subjects=limited.subjects)

    def removing(self, part: Part) -> Scope:
        """Return the scope of the group of a MINUS after `part`: it sees no variable of it."""
        limited = self._limited(part, self.outer | part.bound)
        return Scope(self.outer, near=limited.near, subjects=limited.subjects)

    def _limited(self, part: Part, shared: frozenset[form.Variable]) -> Scope:
        """Return the scope of a negation after `part`, limited to the variables shared with its surroundings."""
        behind = self.behind(part)
        return replace(behind, near=behind.near & shared, subjects=behind.subjects & shared)


def joined(left: Part, right: Part, names: Names) -> Part:
    """Return the join of two independent parts.

    Concatenating their elements is exact: each part tests and binds only its own variables, which `attached` ensures.
    """
    elements = (*left.elements, *attached(right.elements, left.bound, names))
    return Part.of(elements, left.nodes | right.nodes, left.subjects | right.subjects, left.given | right.given)


def attached(elements: Iterable[form.Element], bound: frozenset[form.Variable], names: Names) -> Iterator[form.Element]:
    """Yield elements for a position where `bound` is bound: an assignment to a bound variable becomes a comparison.

    SPARQL joins solutions whose terms are the same, so `sameTerm` is the comparison. The expression compared is in
    error where the assignment is, and both take the solution away.
    """
    for element in elements:
        if isinstance(element, form.Assignment) and element.variable in bound:
            yield form.Filter(same(element.variable, element.expression))
        elif isinstance(element, form.Aggregate):
            yield from _grouped(element, bound, names)
        else:
            yield element
        bound |= form.binds(element)


def _grouped(element: form.Aggregate, bound: frozenset[form.Variable], names: Names) -> Iterator[form.Element]:
    new = {column.variable: names.like(column.variable) for column in element.columns if column.variable in bound}
    columns = tuple(replace(column, variable=new.get(column.variable, column.variable)) for column in element.columns)
    yield replace(element, columns=columns)
    for old, fresh in new.items():
        yield form.Filter(same(old, expressions.expression(sparql.spelling(fresh))))


def same(variable: form.Variable, expression: form.Expression) -> form.Expression:
    """Return the test that a variable equals the value of an expression."""
    text = f"sameTerm({sparql.spelling(variable)}, {expression.text})"
    return expressions.expression(text, expression.place)


def placed(part: Part, element: form.Filter, bound: frozenset[form.Variable]) -> Part:
    """Insert a filter as soon as its variables are bound; `bound` are bound before the part.

    Elements join, bind or drop solutions one by one, so a filter has the same effect anywhere after that.
    """
    needed = frozenset(map(form.Variable, element.expression.variables)) - bound
    elements = part.elements
    if needed:
        for index, before in enumerate(elements[:-1], 1):
            needed -= form.binds(before)
            if not needed:
                return replace(part, elements=(*elements[:index], element, *elements[index:]))
    return replace(part, elements=(*elements, element))
