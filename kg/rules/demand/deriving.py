"""Derive the triples that one query needs from those of a store.

Reading these takes far longer than evaluation if a query needs little: they are cached for the next query.

The patterns of a SPARQL query as goals: what it may read of what rules derive.

A goal is a group's triple patterns with those that restrict them: rows of VALUES, and patterns of groups around it
that each solution has to match. A group behind OPTIONAL, MINUS or EXISTS is restricted by what is before it in the
group around it, and by nothing further out: it may be evaluated before that is joined. A sub-SELECT is not restricted.

A path that repeats, such as `:p+`, asks for all of its predicates. A query that this grammar lacks, such as DESCRIBE,
asks for everything.
"""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING, Final, Self

import numpy as np
from pyoxigraph import NamedNode, Store

from kg.errors import RuleError
from kg.rules import memory
from kg.rules.columns import Tables, Wanted, lines, read_columns, stated, stored, wanted
from kg.rules.demand.magic import Goal, demanded
from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.facts import EMPTY, Facts, Keys, absorb, gathered, lacking, union
from kg.rules.engine.terms import Dictionary
from kg.rules.form import Atom, Pattern, Rule, TripleTerm, Values, Variable
from kg.rules.memory import Memory
from kg.syntax import tree
from kg.syntax.names import PREFIXES
from kg.syntax.parser import parse_query

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from kg.rules.engine.limits import Limits
    from kg.rules.files import RuleSet
    from kg.rules.recording import Names

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
    numbers: Iterator[int] = field(default_factory=count)

    def group(self, nodes: Sequence[tree.Node], outer: Goal) -> None:
        """Add the goals of a group that is joined with `outer`, and of the groups inside."""
        own: list[Atom | Values] = []
        later: list[tuple[tree.Group, bool, Goal]] = []
        for node in nodes:
            if isinstance(node, tree.TriplePattern):
                for atom, joined in self._path(node.subject, node.predicate, node.object):
                    if joined:
                        own.append(atom)
                    else:
                        self.goals.append((atom,))
            elif isinstance(node, tree.ValuesBlock):
                rows = tuple(tuple(term for term in row if term is not None) for row in node.rows)
                if all(len(row) == len(node.variables) for row in rows):
                    own.append(Values(node.variables, rows))
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
        return Variable(f".path {next(self.numbers)}")


@dataclass(frozen=True, slots=True)
class Derived:
    """The triples that a query may read and that the store lacks.

    `whole`: the query may read any predicate, so all rules were evaluated. Wall time in seconds.
    """

    dictionary: Dictionary
    facts: Facts
    whole: bool
    seconds: float

    def chunks(self) -> Iterator[bytes]:
        """Yield the triples as chunks of N-Triples."""
        return lines(self.facts, self.dictionary)


def derive(text: str, rule_set: RuleSet, base: Base, limits: Limits) -> Derived:
    """Return the triples that a set of rules derives for a query from those of a store.

    Raises RuleError: KG202 for rules that cannot be stratified, KG204 for rules that make terms in recursion, KG205 at
    a limit.
    """
    begin = time.perf_counter()
    goals = goals_of(text)
    rewritten = demanded(rule_set.rules, goals)
    program = Program(rewritten.rules)
    program.refuse_minting()
    dictionary = base.memory.dictionary
    asserted, before = base.read_by(rewritten.rules)
    data = lacking(lacking(stated(rule_set.data, dictionary), asserted), before)
    absorb(asserted, data)
    for copy, original in rewritten.copies:
        parts = [facts.keys(dictionary.intern_term(original)) for facts in (asserted, before)]
        asserted.replace(dictionary.intern_term(copy), union(*parts))
    result = evaluate(program, dictionary, asserted, inferred=before, limits=limits)
    facts = stored(result.inferred, dictionary)
    absorb(facts, data)
    matching = _matching(facts, goals, dictionary)
    return Derived(dictionary, matching, open_ended(goals), time.perf_counter() - begin)


@dataclass(frozen=True, slots=True)
class Base:
    """The triples of one generation of a store: `memory` has what `what` wants, and the rest is read when needed."""

    source: Tables
    names: Names
    what: Wanted
    memory: Memory

    @classmethod
    def of(cls, rule_set: RuleSet, source: Tables, generation: int, names: Names, cache: Path) -> Self:
        """Read the triples that a set of rules may read or derive.

        It is cached below the folder `cache`, if writable, for the next query of the same generation.
        """
        what = wanted(rule_set.rules) | Wanted(frozenset(triple.predicate for triple in rule_set.data))
        digest = names.digest(rule_set)
        cached = memory.load(cache, digest)
        if cached is not None and cached.generation == generation:
            return cls(source, names, what, cached)
        base = cls(source, names, what, Memory(generation, digest, names, Dictionary()))
        base.memory.asserted, base.memory.inferred = base._read(what)
        with suppress(OSError):
            memory.save(cache, base.memory)
        return base

    def read_by(self, rules: Iterable[Rule]) -> tuple[Facts, Facts]:
        """Return the asserted and the stored inferred triples that rules, or the patterns of a query, read."""
        asserted, before = self.memory.asserted.copy(), self.memory.inferred.copy()
        further = _without(wanted(rules), self.what)
        if further.predicates or further.members:
            for facts, more in zip((asserted, before), self._read(further), strict=True):
                absorb(facts, more)
        return asserted, before

    def _read(self, what: Wanted) -> tuple[Facts, Facts]:
        """Return the asserted triples of all graphs except the record of builds, and the stored inferences."""
        graphs = self.names.read_by_rules(self.source.graphs())
        dictionary = self.memory.dictionary
        asserted = read_columns(self.source, what, graphs, dictionary)
        return asserted, read_columns(self.source, what, [self.names.inferred], dictionary)


def _without(what: Wanted, read: Wanted) -> Wanted:
    """Return those of some triples that were not read yet."""
    if read.predicates is None or what.predicates is None:
        return Wanted(frozenset())
    members = (pair for pair in what.members - read.members if pair[0] not in read.predicates)
    return Wanted(what.predicates - read.predicates, frozenset(members))


def _matching(facts: Facts, goals: Iterable[Goal], dictionary: Dictionary) -> Facts:
    """Return the triples that match a pattern of a goal."""
    parts: dict[int, list[Keys]] = {}
    for atom in {element for goal in goals for element in goal if isinstance(element, Atom)}:
        predicate = atom.predicate
        among = [dictionary.intern_term(predicate)] if isinstance(predicate, NamedNode) else list(facts.predicates)
        for one in among:
            parts.setdefault(one, []).append(_ends(facts, one, atom, dictionary))
    return gathered(parts)


def _ends(facts: Facts, predicate: int, atom: Atom, dictionary: Dictionary) -> Keys:
    """Return the pairs of a predicate that have the terms that are at the ends of an atom."""
    keys = facts.keys(predicate)
    if isinstance(atom.subject, Variable | TripleTerm) and isinstance(atom.object, Variable | TripleTerm):
        return keys
    mask = np.ones(keys.size, bool)
    for end, column in ((atom.subject, keys >> 32), (atom.object, keys & 0xFFFFFFFF)):
        if not isinstance(end, Variable | TripleTerm):
            mask &= column == dictionary.intern_term(end)
    return keys[mask] if mask.any() else EMPTY
