"""Solutions of a body: its steps are run in the order that the sizes at hand suggest.

Aggregates: SAMPLE takes the term whose spelling is least, and GROUP_CONCAT the order of the spellings, so that runs
agree.
An aggregate in error leaves its variable unbound.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from operator import itemgetter
from typing import TYPE_CHECKING, Final

import numpy as np
import pyoxigraph as ox

from kg.rules.engine.facts import Keys, distinct, pack
from kg.rules.engine.matching import Reading, joined, match, spread
from kg.rules.engine.plan import Assign, Block, Body, Grouped, Match, Nested, Rows, Step, Structure, Test, binds
from kg.rules.engine.shortcuts import has_shortcut
from kg.rules.engine.tables import CHUNK, UNIT, Table, TooManyRowsError, concatenate, distinct_rows, join
from kg.rules.engine.terms import BLANK, TRIPLE, Dictionary

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from kg.rules.engine.blocks import Blocks
    from kg.rules.engine.expressions import Expressions
    from kg.rules.engine.facts import Facts
    from kg.rules.engine.limits import Clock
    from kg.rules.form import Column

_BATCH: Final = 50_000
_ON_INTEGERS: Final = {"SUM": np.add, "MIN": np.minimum, "MAX": np.maximum}
_WHOLE: Final = re.compile(rb'"(0|-?[1-9][0-9]{0,8})"\^\^<http://www\.w3\.org/2001/XMLSchema#integer>')
"""Integers of which four thousand million can be added."""

_INTEGER: Final = b'"%d"^^<http://www.w3.org/2001/XMLSchema#integer>'


def grouped(step: Grouped, table: Table, dictionary: Dictionary, expressions: Expressions, clock: Clock) -> Table:
    """Return one row for each group of the solutions of a body: its keys and its aggregates, in outer columns."""
    names = [inner for inner, _ in step.keys]
    outer = dict(step.keys)
    keys = table.keeping(names)
    packed = keys.packed(names)
    groups, first, member = np.unique(packed, return_index=True, return_inverse=True)
    if not names:
        groups, member = np.zeros(1, np.int64), np.zeros(table.rows, np.int64)
    result = {outer[name]: column[first] for name, column in keys.columns.items()}
    columns = _Columns(step, table, member, groups.size, dictionary)
    for column, name in step.columns:
        result[name] = columns.value(column, expressions, clock)
    return Table(result, groups.size)


class _Columns:
    """Computes the aggregates of one grouping."""

    def __init__(self, step: Grouped, table: Table, member: Keys, groups: int, dictionary: Dictionary) -> None:
        self._step = step
        self._table = table
        self._member = member
        self._groups = groups
        self._dictionary = dictionary

    def value(self, column: Column, expressions: Expressions, clock: Clock) -> Keys:
        """Return the value of an aggregate for each group, 0 where it is in error."""
        if column.expression is None:
            member = self._member
            if column.distinct:
                member = distinct_rows(self._table.plus({".group": member})).columns[".group"]
            return self._integers(np.bincount(member, minlength=self._groups))
        scope = dict(self._step.scope)
        columns = [(name, scope[name]) for name in column.expression.variables if name in scope]
        values = expressions.values(column.expression, self._table, columns, clock)
        member = self._member
        if column.distinct:
            pairs = distinct(pack(member, values))
            member, values = pairs >> 32, pairs & 0xFFFFFFFF
        if column.function == "COUNT":
            return self._integers(np.bincount(member[values != 0], minlength=self._groups))
        if column.function == "SAMPLE":
            return self._sample(member, values)
        numbers = self._whole(values) if column.function in _ON_INTEGERS else None
        if numbers is None or not numbers.size:
            return self._by_engine(column, member, values, clock)
        return self._on_integers(column.function, member, numbers)

    def _whole(self, values: Keys) -> Keys | None:
        """Return the numbers that the values are, None when one of them is not an integer of a few digits."""
        different = distinct(values)
        matches = [_WHOLE.fullmatch(spelling) for spelling in self._dictionary.spellings(different)]
        numbers = [int(part[1]) for part in matches if part]
        if len(numbers) < len(matches):
            return None
        return np.array(numbers, np.int64)[np.searchsorted(different, values)]

    def _on_integers(self, function: str, member: Keys, numbers: Keys) -> Keys:
        """Return the sum, the least or the greatest number of each group; every group has one."""
        order = np.argsort(member, kind="stable")
        begins = np.searchsorted(member[order], np.arange(self._groups))
        return self._integers(_ON_INTEGERS[function].reduceat(numbers[order], begins))

    def _integers(self, counts: Keys) -> Keys:
        """Return the identifiers of numbers."""
        different = distinct(counts)
        identifiers = self._dictionary.intern_all(_INTEGER % count for count in different.tolist())
        return identifiers[np.searchsorted(different, counts)]

    def _in_order(self, member: Keys, values: Keys) -> tuple[Keys, Keys]:
        """Return the rows sorted by group and by the spelling of the value."""
        different = distinct(values)
        spelt = self._dictionary.spellings(different)
        rank = np.empty(different.size, np.int64)
        rank[np.array(sorted(range(len(spelt)), key=spelt.__getitem__), np.int64)] = np.arange(different.size)
        order = np.lexsort((rank[np.searchsorted(different, values)], member))
        return member[order], values[order]

    def _sample(self, member: Keys, values: Keys) -> Keys:
        member, values = self._in_order(member[values != 0], values[values != 0])
        result = np.zeros(self._groups, np.int64)
        result[member[::-1]] = values[::-1]
        return result

    def _by_engine(self, column: Column, member: Keys, values: Keys, clock: Clock) -> Keys:
        """Compute an aggregate by queries over the values, some groups in each."""
        member, values = self._in_order(member, values)
        least = self._blank_minima(column, member, values)
        keep = self._dictionary.kinds(values) != BLANK
        if column.function in {"MIN", "MAX"}:
            # Blank nodes come before all other terms (section 15.1) and cannot be in VALUES.
            member, values = member[keep], values[keep]
        else:
            values = np.where(keep, values, 0)
        results = np.zeros(self._groups, np.int64)
        begin = 0
        while begin < member.size:
            clock.check()
            # A batch ends where a group does; one group may be larger than a batch.
            last = member[min(begin + _BATCH, member.size) - 1]
            end = int(np.searchsorted(member, last, side="right"))
            self._batch(column, member[begin:end], values[begin:end], results)
            begin = end
        empty = np.bincount(member, minlength=self._groups) == 0
        if column.function in {"SUM", "AVG", "GROUP_CONCAT"} and empty.any():
            self._empty(column, empty, results)
        return np.where(least != 0, least, results)

    def _blank_minima(self, column: Column, member: Keys, values: Keys) -> Keys:
        """Return the least blank node of each group, or 0, for MIN and for MAX of groups that have nothing else."""
        minima = np.zeros(self._groups, np.int64)
        if column.function not in {"MIN", "MAX"}:
            return minima
        blank = self._dictionary.kinds(values) == BLANK
        minima[member[blank][::-1]] = values[blank][::-1]
        if column.function == "MAX":
            minima[member[~blank]] = 0
        return minima

    def _batch(self, column: Column, member: Keys, values: Keys, results: Keys) -> None:
        spelt = [spelling or b"UNDEF" for spelling in self._dictionary.spellings(values)]
        rows = b"\n".join(b"(%d %s)" % pair for pair in zip(member.tolist(), spelt, strict=True)).decode()
        text = f"SELECT ?g ({_call(column)} AS ?v) {{ VALUES (?g ?x) {{\n{rows}\n}} }} GROUP BY ?g"
        for solution in ox.Store().query(text):  # type: ignore[union-attr]  # a SELECT gives solutions
            value = solution["v"]
            if value is not None:
                results[int(solution["g"].value)] = self._dictionary.intern_term(value)

    def _empty(self, column: Column, empty: Keys, results: Keys) -> None:
        """Give groups without a value the aggregate of the empty set: zero, or the empty string."""
        for solution in ox.Store().query(f"SELECT ({_call(column)} AS ?v) {{ VALUES ?x {{}} }}"):  # type: ignore[union-attr]  # a SELECT
            if solution["v"] is not None:
                results[empty] = self._dictionary.intern_term(solution["v"])


def _call(column: Column) -> str:
    if column.function != "GROUP_CONCAT":
        return f"{column.function}(?x)"
    separator = column.separator.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\r", "\\r")
    return f'GROUP_CONCAT(STR(?x); SEPARATOR="{separator}")'


_DEDUPLICATE: Final = 2048
"""Smaller tables are not searched for rows that are twice in it."""

_COUNTED: Final = 64
"""With fewer rows the estimates serve."""

_GAIN: Final = 1.5
"""Rows take joins of their own where all of them by one join would give this many times the rows."""

_APART: Final = 1e3
"""What is bound by nothing before it is put off: each of its rows would be joined with all rows."""

_SEED: Final = 4096
"""An aggregate is restricted to the groups asked for when there are no more of them."""


@dataclass(slots=True)
class State:
    """State shared by evaluations over one dictionary, kept between runs."""

    dictionary: Dictionary
    expressions: Expressions
    blocks: Blocks
    clock: Clock
    hidden: frozenset[int] = frozenset()
    """Predicates that variable predicates do not match."""


@dataclass(slots=True)
class Solver:
    """Evaluates the bodies of one rule.

    `sources` has the input of each source of the rule, by number: a change, the data before it, or all data.
    """

    state: State
    sources: Sequence[Facts]
    matched: dict[int, int] = field(default_factory=dict)
    """For each element of the rule's body the rows after it, added up."""
    spreads: dict[tuple[int, bool, bool, bool], tuple[float, float]] = field(default_factory=dict)
    """For each atom, and which of its nodes are known, `spread`: it is asked for before each step."""

    def solutions(
        self, body: Body, outputs: frozenset[str], seeds: Table = UNIT, *, bag: bool = False
    ) -> Iterator[Table]:
        """Return tables that together have the solutions' values of `outputs` and of the columns of `seeds` among them.

        A solution may come more than once; with `bag` each comes as often as it is one, `outputs` being all columns.
        """
        return self._run(seeds, body.steps, outputs, bag=bag)

    def _run(
        self,
        table: Table,
        steps: tuple[Step, ...],
        outputs: frozenset[str],
        *,
        bag: bool,
        first: Step | None = None,
    ) -> Iterator[Table]:
        """Run steps, `first` before the others where it is given."""
        while table.rows and steps:
            ways = [(table, first)] if first else self._next(table, steps)
            if len(ways) > 1:
                for part, step in ways:
                    yield from self._run(part, steps, outputs, bag=bag, first=step)
                return
            ((table, step),) = ways
            first = None
            rest = tuple(other for other in steps if other is not step)
            self.state.clock.check()
            try:
                table = self._after(table, step, rest, outputs, bag=bag)
            except TooManyRowsError as error:
                for piece in np.array_split(np.arange(table.rows), min(table.rows, error.rows // CHUNK + 1)):
                    yield from self._run(table.take(piece), steps, outputs, bag=bag, first=step)
                return
            steps = rest
            if isinstance(step, Grouped | Block) and len(parts := _by_unbound(table, step.names & _binding(rest))) > 1:
                for part in parts:
                    yield from self._run(part, steps, outputs, bag=bag)
                return
        if table.rows:
            yield table.keeping(outputs)

    def _after(self, table: Table, step: Step, rest: tuple[Step, ...], outputs: frozenset[str], *, bag: bool) -> Table:
        """Return the table after a step, without the columns that no step of the rest needs."""
        needed = outputs.union(*map(_reads, rest))
        result = self._apply(table, step, needed)
        self.matched[step.element] = self.matched.get(step.element, 0) + result.rows
        if bag:
            return result
        projected = result.keeping(needed)
        lost = len(projected.columns) < len(table.columns.keys() | binds(step))
        if lost and projected.rows > _DEDUPLICATE and any(isinstance(other, Match) for other in rest):
            return distinct_rows(projected)
        return projected if projected.columns else Table({}, min(projected.rows, 1))

    def _next(self, table: Table, steps: tuple[Step, ...]) -> list[tuple[Table, Step]]:
        """Return the step to run next: the one after which the fewest rows are expected.

        Stop at the first step estimated empty: on small changes most bodies end there. A term may have many times the
        pairs of a mean one, so if the rows become more, what each join gives is counted. Where two joins give the same
        column, each row takes the one that gives fewer: a body that is a cycle then costs no more than the shorter
        side of each row (as joins by variables do: Ngo, Re and Rudra 2014), whichever terms have very many pairs.
        """
        best: tuple[Step, float] | None = None
        sizes: list[tuple[Step, float]] = []
        for step in steps:
            size = self._estimate(table, step)
            if size is None:
                continue
            sizes.append((step, size))
            if best is None or size < best[1]:
                best = step, size
                if size == 0:
                    break
        if best is None:
            raise RuntimeError(steps)
        if best[1] <= table.rows or table.rows < _COUNTED:
            return [(table, best[0])]
        joins = {
            step: candidate
            for step, _ in sizes
            if isinstance(step, Match) and (candidate := joined(table, step, self._reading(step, frozenset())))
        }
        counted = [(step, size) for step, size in sizes if not isinstance(step, Match) or step not in joins]
        counted += [(step, float(counts.sum(dtype=np.int64))) for step, (_, counts) in joins.items()]
        step, size = min(counted, key=itemgetter(1))
        if not isinstance(step, Match) or step not in joins or size <= table.rows:
            return [(table, step)]
        column, least = joins.pop(step)
        ways = [step]
        chosen = np.zeros(table.rows, np.int8)
        for other, (free, counts) in joins.items():
            if free == column:
                chosen[counts < least] = len(ways)
                least = np.minimum(least, counts)
                ways.append(other)
        if least.sum(dtype=np.int64) * _GAIN > size:
            return [(table, step)]
        parts = ((table.take(chosen == number), way) for number, way in enumerate(ways))
        return [(part, way) for part, way in parts if part.rows]

    def _reading(self, step: Match, needed: frozenset[str]) -> Reading:
        return Reading(self.sources[step.number], len(self.state.dictionary), needed, self.state.hidden)

    def _estimate(self, table: Table, step: Step) -> float | None:
        """Estimate rows after a step; None if it cannot run. Cheap filters run before joins, expensive ones after."""
        bound = table.columns.keys()
        if isinstance(step, Match):
            factor, most = self._spread(table, step)
            return min(table.rows * factor, most)
        if isinstance(step, Test):
            cost = 0.1 if has_shortcut(step.expression.text) else 0.55
            return table.rows * cost if step.seen <= bound else None
        if isinstance(step, Assign):
            return table.rows * 1.0 if step.seen <= bound else None
        if isinstance(step, Structure):
            return table.rows * 0.9 if step.term in bound else None
        if isinstance(step, Nested):
            return table.rows * 0.6 if step.shared <= bound else None
        if isinstance(step, Rows):
            return float(step.size) if step.names & bound else step.size * table.rows * (_APART if bound else 1.0)
        return table.rows * 1.1 + 1.0 if not bound or step.names & bound else table.rows * _APART

    def _spread(self, table: Table, step: Match) -> tuple[float, float]:
        columns = table.columns
        subject = step.subject in columns or isinstance(step.subject, int)
        value = step.object in columns or isinstance(step.object, int)
        key = step.number, subject, value, step.predicate in columns
        estimate = self.spreads.get(key)
        if estimate is None:
            estimate = spread(step, self.sources[step.number], subject=subject, value=value, predicate=key[3])
            self.spreads[key] = estimate
        return estimate

    def _apply(self, table: Table, step: Step, needed: frozenset[str]) -> Table:
        if isinstance(step, Match):
            return match(table, step, self._reading(step, needed))
        if isinstance(step, Test):
            return table.take(self.state.expressions.holds(step.expression, table, step.columns, self.state.clock))
        if isinstance(step, Assign):
            return self._assign(table, step)
        if isinstance(step, Structure):
            return self._structure(table, step)
        if isinstance(step, Nested):
            met = self._has_solution(table, step)
            return table.take(~met if step.negated else met)
        if isinstance(step, Rows):
            return join(table, Table(dict(step.columns), step.size))
        if isinstance(step, Block):
            state = self.state
            solutions = state.blocks.solutions(step, self.sources[step.number], state.clock, state.hidden)
            return _compatible(table, solutions)
        return self._grouped(table, step)

    def _assign(self, table: Table, step: Assign) -> Table:
        values = self.state.expressions.values(step.expression, table, step.columns, self.state.clock)
        bound = table.columns.get(step.name)
        if bound is not None:
            return table.take((values == bound) & (values != 0))
        result = table.plus({step.name: values})
        return result if values.all() else result.take(values != 0)

    def _structure(self, table: Table, step: Structure) -> Table:
        dictionary = self.state.dictionary
        table = table.take(dictionary.kinds(table.columns[step.term]) == TRIPLE)
        parts = np.array([dictionary.parts(term) for term in table.columns[step.term].tolist()], np.int64)
        for index, node in enumerate(step.parts):
            column = parts.reshape(-1, 3)[:, index]
            fixed = node if isinstance(node, int) else table.columns.get(node)
            if fixed is None:
                table = table.plus({str(node): column.copy()})
            else:
                same = column == fixed
                table, parts = table.take(same), parts.reshape(-1, 3)[same]
        return table

    def _has_solution(self, table: Table, step: Nested) -> NDArray[np.bool_]:
        """Return for each row whether the inner body has a solution."""
        seeds = table.keeping(step.shared)
        if not step.shared:
            there = any(part.rows for part in self._inner().solutions(step.body, frozenset()))
            return np.full(table.rows, there)
        if len(step.shared) > 1:
            seeds = seeds.plus({".row": np.arange(table.rows)})
            result = np.zeros(table.rows, bool)
            for part in self._inner().solutions(step.body, frozenset({".row"}), seeds):
                result[part.columns[".row"]] = True
            return result
        (name,) = step.shared
        result = np.zeros(len(self.state.dictionary), bool)
        for part in self._inner().solutions(step.body, step.shared, distinct_rows(seeds)):
            result[part.columns[name]] = True
        return result[table.columns[name]]

    def _inner(self) -> Solver:
        """Return a solver whose rows are not counted."""
        return Solver(self.state, self.sources, spreads=self.spreads)

    def _grouped(self, table: Table, step: Grouped) -> Table:
        """Join with the groups; only with those needed, if these are known and few."""
        inner_of = {outer: inner for inner, outer in step.keys}
        shared = sorted(table.columns.keys() & inner_of.keys())
        seeds = UNIT
        if shared and table.rows <= _SEED:
            few = distinct_rows(table.keeping(shared))
            seeds = Table({inner_of[name]: column for name, column in few.columns.items()}, few.rows)
        return _compatible(table, self._inner().groups(step, seeds))

    def groups(self, step: Grouped, seeds: Table) -> Table:
        """Return keys and values of the groups of an aggregate, in outer columns."""
        names = step.body.names
        parts = list(self.solutions(step.body, names, seeds, bag=True))
        table = concatenate([part.keeping(names) for part in parts], names)
        return grouped(step, table, self.state.dictionary, self.state.expressions, self.state.clock)


def _by_unbound(table: Table, names: Iterable[str]) -> list[Table]:
    """Return the rows of a table partitioned by their unbound columns, each part without these columns.

    What is unbound agrees with every value (SPARQL 1.1, section 18.3): a later step binds it as if for the first time.
    """
    parts = [table]
    for name in names:
        apart = []
        for part in parts:
            bound = part.columns[name] != 0 if name in part.columns else np.ones(part.rows, bool)
            if bound.all():
                apart.append(part)
                continue
            apart.append(part.take(~bound).keeping(part.columns.keys() - {name}))
            if bound.any():
                apart.append(part.take(bound))
        parts = apart
    return parts


def _compatible(left: Table, right: Table) -> Table:
    """Join with a table some of whose values may be unbound."""
    parts = _by_unbound(right, left.columns.keys() & right.columns.keys())
    return concatenate([join(left, part) for part in parts], left.columns.keys() | right.columns.keys())


def _binding(steps: Iterable[Step]) -> frozenset[str]:
    """Return the columns that steps bind or join on."""
    return frozenset().union(
        *(step.names for step in steps if isinstance(step, Match | Structure | Rows | Grouped | Block))
    )


def _reads(step: Step) -> frozenset[str]:
    """Return the columns that a step joins on or looks at."""
    if isinstance(step, Match):
        return step.names
    if isinstance(step, Test):
        return step.seen
    return step.shared if isinstance(step, Nested) else step.names
