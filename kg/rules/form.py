"""The internal form of rules: every notation becomes it, every evaluator reads it.

A rule is a head (triples to derive) and a body (a sequence of elements, joined from left to right):

    head   ?x :ancestor ?z
    body   ?x :parent ?y        Atom
           ?y :ancestor ?z      Atom
           FILTER(?x != ?z)     Filter

The meaning is that of SPARQL 1.2 RL (section on evaluation): a solution of the body gives the head's triples; a filter
or an assignment sees what elements before it bound; an expression in error drops the solution. At every point of a body
a variable is either bound in all solutions or in none: OPTIONAL, UNION and UNDEF have become several rules of one
file, told apart by `Rule.part`.

Terms are pyoxigraph's. Nothing here knows notations, stores or ROS.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, Self, TypeAlias, TypeGuard

from pyoxigraph import NamedNode

from kg.syntax.names import RDF_TYPE
from kg.syntax.terms import Pattern, Term, TripleTerm, Variable, has_blank, replaced, variables_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.errors import Place

__all__ = [
    "AUXILIARY",
    "Aggregate",
    "Assignment",
    "Atom",
    "Column",
    "Element",
    "EngineBlock",
    "Exists",
    "Expression",
    "Filter",
    "Pattern",
    "Rule",
    "Term",
    "TripleTerm",
    "Values",
    "Variable",
    "atoms_of",
    "binds",
    "bound_in",
    "has_blank",
    "is_auxiliary",
    "mentions",
    "place_of",
    "readers_of",
    "replaced",
    "variables_of",
]

AUXILIARY: Final = "urn:kg:auxiliary:"
"""Namespace of predicates that decomposition introduces; they are derived like others and never written to a store."""


@dataclass(frozen=True, slots=True)
class Atom:
    """A triple pattern; `asserted`: it matches what was asserted only, not what rules derived (`WHERE DATA`)."""

    subject: Pattern
    predicate: Pattern
    object: Pattern
    asserted: bool = False
    place: Place | None = field(default=None, compare=False)

    @property
    def positions(self) -> tuple[Pattern, Pattern, Pattern]:
        """Subject, predicate and object."""
        return self.subject, self.predicate, self.object

    def replaced(self, by: Mapping[Variable, Pattern]) -> Self:
        """Return the atom with other patterns in the place of some variables."""
        subject, predicate, value = (replaced(position, by) for position in self.positions)
        return replace(self, subject=subject, predicate=predicate, object=value)


@dataclass(frozen=True, slots=True)
class Expression:
    """A SPARQL expression: its text with all names as IRIs in brackets, and the names of its variables in order.

    `mints`: its value may be a term that neither data nor rule has (`IRI`, `STRDT`, `BNODE`, arithmetic,
    string functions). Its value is a function of its variables: rules call no function of time or chance.
    """

    text: str
    variables: tuple[str, ...]
    mints: bool = False
    place: Place | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Filter:
    """Keeps the solutions in which the effective boolean value of the expression is true."""

    expression: Expression


@dataclass(frozen=True, slots=True)
class Assignment:
    """Binds a variable, not bound before, to the value of an expression (`SET`, `BIND`)."""

    variable: Variable
    expression: Expression


@dataclass(frozen=True, slots=True)
class Exists:
    """Keeps the solutions for which `body` has a solution, or with `negated` has none (`NOT`, `EXISTS`, `MINUS`).

    Variables bound before it are bound in `body`; those that only `body` has stay inside it.
    """

    body: tuple[Element, ...]
    negated: bool = False


@dataclass(frozen=True, slots=True)
class Values:
    """Joins with rows of terms; no row has a hole."""

    variables: tuple[Variable, ...]
    rows: tuple[tuple[Term, ...], ...]


@dataclass(frozen=True, slots=True)
class Column:
    """One aggregate: `function` is COUNT, SUM, MIN, MAX, AVG, SAMPLE or GROUP_CONCAT; no expression is `COUNT(*)`."""

    variable: Variable
    function: str
    expression: Expression | None
    distinct: bool = False
    separator: str = " "


@dataclass(frozen=True, slots=True)
class Aggregate:
    """Groups all solutions of `body`, evaluated by itself, by `keys`; binds the keys and one variable for each column.

    As in SPARQL 1.1 (section 11): without keys there is one group even where `body` has no solution.
    """

    keys: tuple[Variable, ...]
    columns: tuple[Column, ...]
    body: tuple[Element, ...]


@dataclass(frozen=True, slots=True)
class EngineBlock:
    """A group of SPARQL that was not decomposed: `text` is between the braces of a WHERE clause.

    It binds `variables`. One of `optional` may stay unbound in a solution: no other element mentions it, and a triple
    of the head that has it is not derived from that solution. `reads` are the predicates it reads, None when it may
    read any; with `monotone` more data never takes a solution away.
    """

    text: str
    variables: tuple[Variable, ...]
    optional: tuple[Variable, ...] = ()
    reads: frozenset[NamedNode] | None = None
    monotone: bool = False
    place: Place | None = field(default=None, compare=False)


Element: TypeAlias = Atom | Filter | Assignment | Exists | Values | Aggregate | EngineBlock


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule; `name` is `family/name`, the path of its file below a folder of rules without the ending.

    A file may give several: those that it states, and those that one statement was split into; `part` numbers them
    from one. `order` is `sh:order`: rules of a lower order are finished before.
    """

    name: str
    head: tuple[Atom, ...]
    body: tuple[Element, ...]
    place: Place
    part: int = 1
    order: float = 0.0

    def __str__(self) -> str:
        return self.name if self.part == 1 else f"{self.name}#{self.part}"

    @property
    def creates_nodes(self) -> bool:
        """Whether each solution gives blank nodes of its own."""
        return any(has_blank(position) for atom in self.head for position in atom.positions)


def readers_of(body: Iterable[Element]) -> Iterator[tuple[Atom | EngineBlock, bool]]:
    """Yield what reads triples in a body, at any depth, with whether more triples may take solutions away around it."""
    for element in body:
        if isinstance(element, Atom | EngineBlock):
            yield element, False
        elif isinstance(element, Exists | Aggregate):
            denied = isinstance(element, Aggregate) or element.negated
            yield from ((each, denied or negated) for each, negated in readers_of(element.body))


def atoms_of(body: Iterable[Element]) -> Iterator[tuple[Atom, bool]]:
    """Yield the atoms among `readers_of`."""
    return ((each, negated) for each, negated in readers_of(body) if isinstance(each, Atom))


def is_auxiliary(predicate: object) -> TypeGuard[NamedNode]:
    """Return whether decomposition introduced a predicate."""
    return isinstance(predicate, NamedNode) and predicate.value.startswith(AUXILIARY)


def place_of(element: Element) -> Place | None:
    """Return the place of an element of a body: its own, that of its expression, or of the first part that has one."""
    if isinstance(element, Filter | Assignment):
        return element.expression.place
    if isinstance(element, Exists | Aggregate):
        return next((place for part in element.body if (place := place_of(part))), None)
    return None if isinstance(element, Values) else element.place


def binds(element: Element) -> frozenset[Variable]:
    """Return the variables that are bound behind an element; those of an EngineBlock that may stay unbound too."""
    if isinstance(element, Atom):
        return _variables(element)
    if isinstance(element, Assignment):
        return frozenset((element.variable,))
    if isinstance(element, Values | EngineBlock):
        return frozenset(element.variables)
    if isinstance(element, Aggregate):
        return frozenset((*element.keys, *(column.variable for column in element.columns)))
    return frozenset()


def _variables(atom: Atom) -> frozenset[Variable]:
    """Return the variables of an atom; nearly all are in it by themselves, so only triple terms are searched."""
    positions = atom.positions
    result = [position for position in positions if isinstance(position, Variable)]
    for position in positions:
        if isinstance(position, TripleTerm):
            result += variables_of(position)
    return frozenset(result)


def bound_in(body: Iterable[Element]) -> frozenset[Variable]:
    """Return the variables that are bound behind a body."""
    return frozenset().union(*map(binds, body))


def mentions(element: Element) -> frozenset[Variable]:
    """Return all variables that an element shares with the body it is in, were they bound there.

    Those inside EXISTS count, for it sees what is before it; those inside an aggregate do not.
    """
    if isinstance(element, Filter):
        return frozenset(map(Variable, element.expression.variables))
    if isinstance(element, Assignment):
        return binds(element).union(map(Variable, element.expression.variables))
    if isinstance(element, Exists):
        return frozenset().union(*map(mentions, element.body))
    return binds(element)


def names_in(elements: Iterable[Element]) -> Iterator[Variable]:
    """Yield the variables in the place of predicates or classes, at any depth."""
    for atom, _ in atoms_of(elements):
        if isinstance(atom.predicate, Variable):
            yield atom.predicate
        elif atom.predicate == RDF_TYPE and isinstance(atom.object, Variable):
            yield atom.object


def filled(body: Iterable[Element], by: Mapping[Variable, Pattern]) -> tuple[Element, ...]:
    """Return a body with terms in the place of variables in its triple patterns, at any depth."""
    return tuple(
        element.replaced(by)
        if isinstance(element, Atom)
        else replace(element, body=filled(element.body, by))
        if isinstance(element, Exists)
        else element
        for element in body
    )
