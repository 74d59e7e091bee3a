"""Aggregates as SPARQL 1.1 defines them (section 11.5): counts by arithmetic, the others by the store's engine.

SAMPLE takes the term whose spelling is least, and GROUP_CONCAT the order of the spellings, so that runs agree.
An aggregate in error leaves its variable unbound.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

import numpy as np
import pyoxigraph as ox

from kg.rules.engine.facts import Keys, distinct, pack
from kg.rules.engine.tables import Table, distinct_rows
from kg.rules.engine.terms import BLANK, Dictionary

if TYPE_CHECKING:
    from kg.rules.engine.expressions import Expressions
    from kg.rules.engine.limits import Clock
    from kg.rules.engine.plan import Grouped
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
