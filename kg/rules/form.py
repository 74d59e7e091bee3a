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

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.syntax.terms import Pattern, Term, TripleTerm, Variable, variables_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pyoxigraph import NamedNode

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
    "flat",
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


@dataclass(frozen=True, slots=True)
class Expression:
    """A SPARQL expression: its text with all names as IRIs in brackets, and the names of its variables in order.

    `mints`: its value may be a term that neither data nor rule has (`IRI`, `STRDT`, `BNODE`, arithmetic,
    string functions); `volatile`: it differs from call to call (`RAND`, `NOW`, `UUID`, `STRUUID`, `BNODE`).
    """

    text: str
    variables: tuple[str, ...]
    mints: bool = False
    volatile: bool = False
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


def atoms_of(body: tuple[Element, ...]) -> Iterator[tuple[Atom, bool]]:
    """Yield each atom of a body, those of inner bodies too, with whether more matches may take solutions away."""
    for element in body:
        if isinstance(element, Atom):
            yield element, False
        elif isinstance(element, Exists):
            for atom, negated in atoms_of(element.body):
                yield atom, negated or element.negated
        elif isinstance(element, Aggregate):
            for atom, _ in atoms_of(element.body):
                yield atom, True


def flat(body: Iterable[Element]) -> Iterator[Atom | EngineBlock]:
    """Yield the atoms and blocks of a body, those of inner bodies too."""
    for element in body:
        if isinstance(element, Exists | Aggregate):
            yield from flat(element.body)
        elif isinstance(element, Atom | EngineBlock):
            yield element
