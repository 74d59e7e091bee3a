"""The syntax tree of `.rq` and `.srl` files; offsets count characters of the text from zero.

Names are resolved: prefixes are expanded, relative IRIs made absolute, `a` is rdf:type, lists and `[ ... ]` are
triples. Blank nodes are variables with names starting with `.` in patterns (labels follow the dot), and `BlankNode` in
templates and DATA.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from kg.syntax.terms import Pattern, Term, Variable, variables_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pyoxigraph import NamedNode


@dataclass(frozen=True, slots=True)
class Span:
    """Start and end offset."""

    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Inverse:
    """`^path`."""

    path: Path


@dataclass(frozen=True, slots=True)
class Sequence:
    """`first/second`."""

    parts: tuple[Path, ...]


@dataclass(frozen=True, slots=True)
class Alternative:
    """`first|second`."""

    parts: tuple[Path, ...]


@dataclass(frozen=True, slots=True)
class Repeat:
    """`path*` (least 0), `path+` (least 1), or `path?` (least 0, not `many`)."""

    path: Path
    least: int
    many: bool


@dataclass(frozen=True, slots=True)
class Negated:
    """`!(first|^second)`."""

    forward: tuple[NamedNode, ...]
    backward: tuple[NamedNode, ...]


Path: TypeAlias = "NamedNode | Variable | Inverse | Sequence | Alternative | Repeat | Negated"


@dataclass(frozen=True, slots=True)
class TriplePattern:
    """A triple of a pattern or a template; only patterns have paths."""

    subject: Pattern
    predicate: Path
    object: Pattern
    span: Span


@dataclass(frozen=True, slots=True)
class AggregateCall:
    """`COUNT(DISTINCT ?x)` inside an expression; `argument` is None for `COUNT(*)`.

    `text` is its spelling in the expression's text, for replacement.
    """

    function: str
    argument: Expression | None
    distinct: bool
    separator: str
    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression as text: `text` has IRIs in brackets instead of prefixed names.

    `variables` are its free ones, in order of appearance, including those inside EXISTS but not inside aggregates;
    `exists` are the patterns of EXISTS and NOT EXISTS in it, `aggregates` the calls of aggregates.
    """

    text: str
    variables: tuple[str, ...]
    span: Span
    exists: tuple[Exists, ...] = ()
    aggregates: tuple[AggregateCall, ...] = ()


@dataclass(frozen=True, slots=True)
class Filter:
    """`FILTER expression`. A filter that is only EXISTS or NOT EXISTS is an `Exists` instead."""

    expression: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Exists:
    """`FILTER EXISTS {}`, `FILTER NOT EXISTS {}`, and SPARQL RL's `NOT {}` and `NOT DATA {}` (`asserted`)."""

    group: Group
    negated: bool
    asserted: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Bind:
    """`BIND(expression AS ?variable)` or `SET(?variable := expression)`."""

    variable: Variable
    expression: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class ValuesBlock:
    """`VALUES`; None is UNDEF."""

    variables: tuple[Variable, ...]
    rows: tuple[tuple[Term | None, ...], ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Optional:
    """`OPTIONAL {}`."""

    group: Group
    span: Span


@dataclass(frozen=True, slots=True)
class Minus:
    """`MINUS {}`."""

    group: Group
    span: Span


@dataclass(frozen=True, slots=True)
class Union:
    """`{} UNION {}`; also a group inside a group, with one branch."""

    groups: tuple[Group, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class GraphBlock:
    """`GRAPH name {}`."""

    name: NamedNode | Variable
    group: Group
    span: Span


@dataclass(frozen=True, slots=True)
class Projection:
    """A column of a sub-SELECT: a variable, with its expression for `(expression AS ?variable)`."""

    variable: Variable
    expression: Expression | None


@dataclass(frozen=True, slots=True)
class SubSelect:
    """`{ SELECT ... }`; `sliced`: it has LIMIT or OFFSET. No projections means `SELECT *`.

    `text` is all of it without braces, respelt like that of a group.

    An unnamed expression in GROUP BY has a variable whose name begins with `.`. VALUES after the sub-SELECT is the last
    element of `group`.
    """

    projections: tuple[Projection, ...]
    distinct: bool
    group: Group
    keys: tuple[Projection, ...]
    having: tuple[Expression, ...]
    sliced: bool
    span: Span
    text: str = field(default="", compare=False)


Node: TypeAlias = (
    "TriplePattern | Filter | Exists | Bind | ValuesBlock | Optional | Minus | Union | GraphBlock | SubSelect"
)


@dataclass(frozen=True, slots=True)
class Group:
    """The elements between braces, in the order of the text; `span` includes the braces.

    `text` is the group with its braces, respelt with IRIs in brackets instead of prefixed names.
    """

    nodes: tuple[Node, ...]
    span: Span
    text: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Call:
    """A call of a function: its name (upper case for built-in ones, the IRI of others) and number of arguments.

    `span` is that of the name.
    """

    name: str
    arguments: int
    span: Span


@dataclass(frozen=True, slots=True)
class RuleText:
    """One rule as written: template and pattern; `asserted`: `WHERE DATA`; `identifier`: the IRI after `RULE`.

    `calls` are all calls of functions in the pattern, inner ones before those around them.
    """

    template: tuple[TriplePattern, ...]
    group: Group
    asserted: bool
    span: Span
    identifier: NamedNode | None = None
    calls: tuple[Call, ...] = ()


@dataclass(frozen=True, slots=True)
class RuleUnit:
    """A whole file: a `.rq` has one rule; a `.srl` any number, with imports and data.

    The terms of `data` have no variables; their blank nodes are shared by the whole file.
    """

    rules: tuple[RuleText, ...]
    data: tuple[TriplePattern, ...]
    imports: tuple[NamedNode, ...]
    prefixes: dict[str, str]


def groups_of(node: Node) -> tuple[Group, ...]:
    """Return the groups that a node is made of; those of EXISTS in its expressions are not among them."""
    if isinstance(node, Union):
        return node.groups
    return () if isinstance(node, TriplePattern | Filter | Bind | ValuesBlock) else (node.group,)


def expressions_of(node: Node) -> tuple[Expression, ...]:
    """Return the expressions of a node itself."""
    if isinstance(node, Filter | Bind):
        return (node.expression,)
    if not isinstance(node, SubSelect):
        return ()
    columns = (column.expression for column in (*node.projections, *node.keys))
    return (*(expression for expression in columns if expression), *node.having)


def visible(nodes: Iterable[Node]) -> set[str]:
    """Return the names of the variables that may be bound after `nodes`, including those of blank nodes."""
    return {name for node in nodes for name in _names(node)}


def _names(node: Node) -> Iterator[str]:
    if isinstance(node, TriplePattern):
        if isinstance(node.predicate, Variable):
            yield node.predicate.name
        for part in (node.subject, node.object):
            yield from (variable.name for variable in variables_of(part))
    elif isinstance(node, Optional | GraphBlock | Union):
        if isinstance(node, GraphBlock) and isinstance(node.name, Variable):
            yield node.name.name
        for group in groups_of(node):
            yield from visible(group.nodes)
    elif isinstance(node, Bind):
        yield node.variable.name
    elif isinstance(node, ValuesBlock):
        yield from (variable.name for variable in node.variables)
    elif isinstance(node, SubSelect):
        yield from (projection.variable.name for projection in node.projections)
        if not node.projections:
            yield from visible(node.group.nodes)
