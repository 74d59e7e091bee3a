"""The patterns of a SPARQL query as goals: what it may read of what rules derive.

A goal is a group's triple patterns with those that restrict them: rows of VALUES, and patterns of groups around it
that each solution has to match. A group behind OPTIONAL, MINUS or EXISTS is restricted by what is before it in the
group around it, and by nothing further out: it may be evaluated before that is joined. A sub-SELECT is not restricted.

A path that repeats, such as `:p+`, asks for all of its predicates. A query that this grammar lacks, such as DESCRIBE,
asks for everything.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING, Final

from pyoxigraph import Store

from kg.errors import RuleError
from kg.rules.form import Atom, Values, Variable
from kg.syntax import tree
from kg.syntax.names import PREFIXES
from kg.syntax.parser import parse_query

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.demand.magic import Goal
    from kg.rules.form import Pattern, Term

_EVERYTHING: Final[Goal] = (Atom(Variable("s"), Variable("p"), Variable("o")),)


def goals_of(text: str) -> tuple[Goal, ...]:
    """Return the goals of a query that guards let through; none for invalid SPARQL."""
    try:
        unit = parse_query(text, "query")
    except RuleError:
        return (_EVERYTHING,) if _is_sparql(text) else ()
    reader = _Reader()
    reader.group(unit.group.nodes, ())
    # EXISTS in columns, HAVING and ORDER BY is part of no group.
    return tuple(reader.goals) if reader.exists == unit.exists else (_EVERYTHING,)


def _is_sparql(text: str) -> bool:
    try:
        Store().query(text, prefixes=dict(PREFIXES))
    except SyntaxError:
        return False
    return True


def open_ended(goals: Sequence[Goal]) -> bool:
    """Return whether a goal has a variable as predicate: every rule may answer it."""
    return any(isinstance(atom, Atom) and isinstance(atom.predicate, Variable) for goal in goals for atom in goal)


@dataclass(slots=True)
class _Reader:
    """Gathers the goals of groups; `exists` counts the EXISTS that were met."""

    goals: list[Goal] = field(default_factory=list)
    exists: int = 0
    made: Iterator[int] = field(default_factory=count)

    def group(self, nodes: Sequence[tree.Node], outer: Goal) -> None:
        """Add the goals of a group that is joined with `outer`, and of the groups inside."""
        own: list[Atom | Values] = []
        later: list[tuple[tree.Group, bool, Goal]] = []
        for node in nodes:
            if isinstance(node, tree.TriplePattern):
                self._triple(node, own)
            elif isinstance(node, tree.ValuesBlock):
                rows = tuple(row for row in node.rows if None not in row)
                if len(rows) == len(node.rows):
                    own.append(Values(node.variables, _full(rows)))
            else:
                before = tuple(own)
                later += ((inner, joined, before) for inner, joined in self._inner(node))
        mine = (*own, *outer)
        if own:
            self.goals.append(mine)
        for inner, joined, before in later:
            self.group(inner.nodes, mine if joined else before)

    def _inner(self, node: tree.Node) -> Iterator[tuple[tree.Group, bool]]:
        """Yield the groups of a node, each with whether it is joined with all of the group around it."""
        if isinstance(node, tree.Union):
            yield from ((group, True) for group in node.groups)
        elif isinstance(node, tree.GraphBlock):
            yield node.group, True
        elif isinstance(node, tree.Optional | tree.Minus):
            yield node.group, False
        elif isinstance(node, tree.Exists):
            self.exists += 1
            yield node.group, False
        elif isinstance(node, tree.SubSelect):
            # Its variables may have the names of others, and its rows may be counted.
            self.group(node.group.nodes, ())
        elif isinstance(node, tree.Filter | tree.Bind):
            for exists in node.expression.exists:
                self.exists += 1
                yield exists.group, False

    def _triple(self, node: tree.TriplePattern, own: list[Atom | Values]) -> None:
        for atom, joined in self._path(node.subject, node.predicate, node.object):
            if joined:
                own.append(atom)
            else:
                self.goals.append((atom,))

    def _path(self, subject: Pattern, path: tree.Path, value: Pattern) -> Iterator[tuple[Atom, bool]]:
        """Yield the triples that a path may pass, each with whether all solutions pass it."""
        if isinstance(path, tree.Inverse):
            yield from self._path(value, path.path, subject)
        elif isinstance(path, tree.Sequence):
            ends = [subject, *(self._fresh() for _ in path.parts[1:]), value]
            for index, part in enumerate(path.parts):
                yield from self._path(ends[index], part, ends[index + 1])
        elif isinstance(path, tree.Alternative):
            for part in path.parts:
                yield from ((atom, False) for atom, _ in self._path(subject, part, value))
        elif isinstance(path, tree.Repeat):
            yield from ((atom, False) for atom, _ in self._path(self._fresh(), path.path, self._fresh()))
        elif isinstance(path, tree.Negated):
            yield Atom(self._fresh(), self._fresh(), self._fresh()), False
        else:
            yield Atom(subject, path, value), True

    def _fresh(self) -> Variable:
        return Variable(f".path {next(self.made)}")


def _full(rows: Sequence[tuple[Term | None, ...]]) -> tuple[tuple[Term, ...], ...]:
    return tuple(tuple(term for term in row if term is not None) for row in rows)
