"""Values of expressions: computed by the store's engine, once for each combination of terms.

The combinations that a table has are numbered and handed over as one `VALUES`; results are remembered by the text of
the expression and the identifiers, across rounds and runs. What identifiers alone can tell, they do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import Store, Variable

from kg.rules import form
from kg.rules.engine.facts import EMPTY, distinct
from kg.rules.engine.shortcuts import shortcut
from kg.rules.engine.tables import Table, among
from kg.rules.engine.terms import BLANK
from kg.rules.sparql import spelling

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from kg.rules.engine.facts import Keys
    from kg.rules.engine.limits import Clock
    from kg.rules.engine.terms import Dictionary
    from kg.rules.form import Expression

__all__ = ["ERROR", "Expressions"]

ERROR: Final = 0
"""What stands for the value of an expression in error."""

_PACKABLE: Final = 2
_BATCH: Final = 20_000
"""Rows in one `VALUES`: the text of a query stays some megabytes."""


class Expressions:
    """Evaluates expressions over tables of one dictionary and remembers the values."""

    def __init__(self, dictionary: Dictionary) -> None:
        self._dictionary = dictionary
        self._store = Store()
        self._memo: dict[tuple[str, tuple[str, ...]], _Memo] = {}
        self._true = dictionary.intern(b'"true"^^<http://www.w3.org/2001/XMLSchema#boolean>')

    def holds(
        self, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock
    ) -> NDArray[np.bool_]:
        """Tell for each row whether the effective boolean value is true; an error is not."""
        quick = shortcut(expression, table, dict(columns), self._dictionary)
        if quick is not None:
            return quick
        text = f"IF({expression.text}, true, false)"
        truth: NDArray[np.bool_] = self._values(text, expression, table, columns, clock) == self._true
        return truth

    def values(self, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock) -> Keys:
        """Return the value for each row, `ERROR` where there is none."""
        return self._values(expression.text, expression, table, columns, clock)

    def _values(
        self, text: str, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock
    ) -> Keys:
        seen = {name: table.columns[column] for name, column in columns if name in expression.variables}
        names = tuple(seen)
        arguments = Table(seen, table.rows)
        if expression.volatile:
            return self._compute(text, names, arguments, clock)
        memo = self._memo.setdefault((text, names), _Memo())
        distinct, places = _distinct(arguments)
        known, missing = memo.look_up(distinct)
        if missing.size:
            values = self._compute(text, names, distinct.take(missing), clock)
            known[missing] = values
            memo.remember(distinct.take(missing), values)
        return known[places]

    def _compute(self, text: str, names: tuple[str, ...], arguments: Table, clock: Clock) -> Keys:
        """Evaluate an expression for each row, whatever was remembered."""
        found = np.full(arguments.rows, ERROR, np.int64)
        kinds = self._dictionary.kinds()
        blank = np.zeros(arguments.rows, bool)
        for column in arguments.columns.values():
            blank |= kinds[column] == BLANK
        plain = np.flatnonzero(~blank)
        for begin in range(0, plain.size, _BATCH):
            clock.check()
            rows = plain[begin : begin + _BATCH]
            self._batch(text, names, arguments.take(rows), rows, found)
        for row in np.flatnonzero(blank).tolist():
            found[row] = self._single(text, names, arguments, row)
        return found

    def _batch(self, text: str, names: tuple[str, ...], arguments: Table, rows: Keys, found: Keys) -> None:
        """Evaluate an expression for rows without blank nodes, by one query."""
        spelt = [
            [spelling or b"UNDEF" for spelling in self._dictionary.spellings(arguments.columns[name])] for name in names
        ]
        shown = " ".join(["?kg_row", *map(_shown, names)])
        lines = b"\n".join(b"(%s)" % b" ".join(row) for row in zip(_numbers(arguments.rows), *spelt, strict=True))
        query = f"SELECT ?kg_row ?kg_value {{ VALUES ({shown}) {{\n{lines.decode()}\n}} BIND({text} AS ?kg_value) }}"
        values: dict[object, int] = {}
        for solution in self._store.query(query):  # type: ignore[union-attr]  # a SELECT gives solutions
            value = solution["kg_value"]
            if value is not None:
                identifier = values.get(value)
                if identifier is None:
                    identifier = values[value] = self._dictionary.intern_term(value)
                found[rows[int(solution["kg_row"].value)]] = identifier

    def _single(self, text: str, names: tuple[str, ...], arguments: Table, row: int) -> int:
        """Evaluate an expression for one row; blank nodes cannot stand in `VALUES`."""
        identifiers = {name: int(arguments.columns[name][row]) for name in names}
        bindings = {
            Variable(_shown(name)[1:]): self._dictionary.term(identifier)
            for name, identifier in identifiers.items()
            if identifier
        }
        shown = " ".join(f"?{variable.value}" for variable in bindings)
        query = f"SELECT {shown} ({text} AS ?kg_value) {{}}"
        for solution in self._store.query(query, substitutions=bindings):  # type: ignore[union-attr]  # a SELECT gives solutions
            value = solution["kg_value"]
            return ERROR if value is None else self._dictionary.intern_term(value)
        return ERROR


def _distinct(arguments: Table) -> tuple[Table, Keys]:
    """Return each row once, and for each row of the table its place among them."""
    keys = arguments.packed(list(arguments.columns))
    if keys.size > 1 and (keys[1:] > keys[:-1]).all():
        return arguments, np.arange(keys.size)
    ordered = distinct(keys)
    places = np.searchsorted(ordered, keys)
    first = np.empty(ordered.size, np.int64)
    first[places] = np.arange(keys.size)
    return arguments.take(first), places


def _shown(name: str) -> str:
    """Return how a variable stands in the text of an expression."""
    return spelling(form.Variable(name))


def _numbers(rows: int) -> list[bytes]:
    return [b"%d" % number for number in range(rows)]


class _Memo:
    """The values of one expression: sorted keys of the arguments with their values; by row where there are many."""

    def __init__(self) -> None:
        self._keys = EMPTY
        self._values = EMPTY
        self._rows: dict[tuple[int, ...], int] = {}

    def look_up(self, arguments: Table) -> tuple[Keys, Keys]:
        """Return the values of distinct arguments, `ERROR` for those not known, and the places of the latter."""
        if len(arguments.columns) > _PACKABLE:
            found = [self._rows.get(row, -1) for row in _tuples(arguments)]
            values = np.array(found, np.int64)
            return np.maximum(values, ERROR), np.flatnonzero(values < 0)
        keys = arguments.packed(list(arguments.columns))
        known = among(keys, self._keys)
        values = np.full(keys.size, ERROR, np.int64)
        values[known] = self._values[np.searchsorted(self._keys, keys[known])]
        return values, np.flatnonzero(~known)

    def remember(self, arguments: Table, values: Keys) -> None:
        """Keep the values of distinct arguments that were not known."""
        if len(arguments.columns) > _PACKABLE:
            self._rows.update(zip(_tuples(arguments), values.tolist(), strict=True))
            return
        keys = np.concatenate([self._keys, arguments.packed(list(arguments.columns))])
        order = np.argsort(keys, kind="stable")
        self._keys, self._values = keys[order], np.concatenate([self._values, values])[order]


def _tuples(arguments: Table) -> Iterator[tuple[int, ...]]:
    return zip(*(column.tolist() for column in arguments.columns.values()), strict=True)
