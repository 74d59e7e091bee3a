"""Rules prepared for evaluation: terms are identifiers, every variable of a rule has a column of its own name.

Atoms, those of inner bodies too, and blocks of SPARQL are numbered over the whole rule: `RulePlan.sources`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from kg.rules.form import Atom, Column, EngineBlock, Expression, Rule

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from kg.rules.engine.facts import Facts


@dataclass(frozen=True, slots=True)
class Fresh:
    """A blank node of a head: a new one in each solution."""

    label: str


Node: TypeAlias = int | str
"""A term's identifier, or the name of a column."""

HeadNode: TypeAlias = "Node | Fresh | tuple[HeadNode, HeadNode, HeadNode]"
"""What stands in a position of a head; three nodes are a triple term."""


@dataclass(frozen=True, slots=True)
class Match:
    """An atom; `number` is its place among the sources, `element` that of the element of the body it belongs to."""

    number: int
    subject: Node
    predicate: Node
    object: Node
    element: int
    names: frozenset[str] = field(init=False, compare=False, repr=False)
    """The columns it binds; asked for at every step of every evaluation, so made once."""

    def __post_init__(self) -> None:
        nodes = (self.subject, self.predicate, self.object)
        object.__setattr__(self, "names", frozenset(node for node in nodes if isinstance(node, str)))


@dataclass(frozen=True, slots=True)
class Structure:
    """Takes the triple terms of a column apart; drops the rows whose term is none or does not fit."""

    term: str
    parts: tuple[Node, Node, Node]
    element: int

    @property
    def names(self) -> frozenset[str]:
        """The columns it binds or reads."""
        return frozenset({self.term, *(node for node in self.parts if isinstance(node, str))})


@dataclass(frozen=True, slots=True)
class Test:
    """A filter; `columns` has the column of each variable that it sees."""

    expression: Expression
    columns: tuple[tuple[str, str], ...]
    element: int
    seen: frozenset[str] = field(init=False, compare=False, repr=False)
    """The columns that it sees, made once."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "seen", frozenset(column for _, column in self.columns))


@dataclass(frozen=True, slots=True)
class Assign:
    """An assignment; where its column is bound already, it keeps the rows whose value is the same term."""

    name: str
    expression: Expression
    columns: tuple[tuple[str, str], ...]
    element: int
    seen: frozenset[str] = field(init=False, compare=False, repr=False)
    """The columns that the expression sees, made once."""
    names: frozenset[str] = field(init=False, compare=False, repr=False)
    """These, and the one that it gives a value."""

    def __post_init__(self) -> None:
        seen = frozenset(column for _, column in self.columns)
        object.__setattr__(self, "seen", seen)
        object.__setattr__(self, "names", seen | {self.name})


@dataclass(frozen=True, slots=True)
class Nested:
    """An inner body that has a solution, or has none; `shared` are the columns bound before it."""

    body: Body
    negated: bool
    shared: frozenset[str]
    element: int


@dataclass(frozen=True, slots=True)
class Rows:
    """Values: one column of identifiers for each name."""

    names: frozenset[str]
    columns: tuple[tuple[str, NDArray[np.int64]], ...]
    size: int
    element: int


@dataclass(frozen=True, slots=True)
class Grouped:
    """An aggregate: `keys` pairs inner with outer columns, `columns` each aggregate with its outer column."""

    body: Body
    keys: tuple[tuple[str, str], ...]
    columns: tuple[tuple[Column, str], ...]
    scope: tuple[tuple[str, str], ...]
    element: int

    @property
    def names(self) -> frozenset[str]:
        """The columns it binds."""
        return frozenset(outer for _, outer in self.keys) | frozenset(name for _, name in self.columns)


@dataclass(frozen=True, slots=True)
class Block:
    """A block of SPARQL; `columns` pairs its variables with columns."""

    number: int
    block: EngineBlock
    columns: tuple[tuple[str, str], ...]
    element: int

    @property
    def names(self) -> frozenset[str]:
        """The columns it binds."""
        return frozenset(name for _, name in self.columns)


Step: TypeAlias = Match | Structure | Test | Assign | Nested | Rows | Grouped | Block


def binds(step: Step) -> frozenset[str]:
    """Return the columns that are bound once a step has run."""
    if isinstance(step, Assign):
        return frozenset({step.name})
    return frozenset() if isinstance(step, Test | Nested) else step.names


@dataclass(frozen=True, slots=True)
class Body:
    """Steps to run in any order that respects the variables visible to filters, assignments and inner bodies."""

    steps: tuple[Step, ...]
    numbers: frozenset[int]
    """Of the atoms and blocks in it, those of inner bodies too."""
    names: frozenset[str]
    """The columns bound once all steps have run."""


@dataclass(frozen=True, slots=True)
class Head:
    """A triple of the head."""

    subject: HeadNode
    predicate: HeadNode
    object: HeadNode

    @property
    def nodes(self) -> tuple[HeadNode, HeadNode, HeadNode]:
        """Subject, predicate and object."""
        return self.subject, self.predicate, self.object


@dataclass(frozen=True, slots=True)
class Source:
    """The input of an atom or a block; `positive`: more of it only adds solutions, each through it."""

    reads: Atom | EngineBlock
    positive: bool

    @property
    def asserted(self) -> bool:
        """Whether it reads asserted triples only."""
        return isinstance(self.reads, Atom) and self.reads.asserted


@dataclass(frozen=True, slots=True)
class RulePlan:
    """A rule prepared for one dictionary."""

    rule: Rule
    body: Body
    heads: tuple[Head, ...]
    sources: tuple[Source, ...]
    solution: tuple[tuple[str, str], ...]
    """The variables that tell one solution from another, with their columns; sorted by name."""
    outputs: frozenset[str] = field(default_factory=frozenset)
    """The columns that the head needs."""
    resources: frozenset[HeadNode] = field(default_factory=frozenset)
    """Nodes of heads that may stand as subjects for certain: columns that are subjects of atoms, and blank nodes."""

    def inputs(self, asserted: Facts, facts: Facts) -> list[Facts]:
        """Return what each source reads: all known triples, or only those asserted."""
        return [asserted if source.asserted else facts for source in self.sources]
