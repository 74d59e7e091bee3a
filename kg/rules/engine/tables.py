"""Solutions as a table: one column of identifiers for each variable that is still needed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.rules.engine.facts import EMPTY, Keys, distinct, in_sorted, pack

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray


CHUNK: Final = 1 << 19
"""Rows that a join gives at once, about: one that would give over twice as many is to be done in pieces."""


_MANY: Final = 1 << 16
_FACTOR: Final = np.uint64(0x9E3779B97F4A7C15)
"""Two to the 64th, by the golden ratio."""


class TooManyRowsError(Exception):
    """A join of a table with more than one row would give too many rows at once."""

    def __init__(self, rows: int) -> None:
        super().__init__(rows)
        self.rows = rows


@dataclass(frozen=True, slots=True)
class Table:
    """Solutions: `columns` by variable, all of length `rows`. Without columns it still has a number of rows."""

    columns: Mapping[str, Keys]
    rows: int

    def take(self, chosen: NDArray[np.int64] | NDArray[np.bool_] | slice) -> Table:
        """Return the rows chosen by position, mask or range."""
        columns = {name: column[chosen] for name, column in self.columns.items()}
        if columns:
            return Table(columns, next(iter(columns.values())).size)
        return Table({}, int(np.arange(self.rows)[chosen].size))

    def keeping(self, names: Iterable[str]) -> Table:
        """Return the table with these of its columns only."""
        chosen = set(names)
        return Table({name: column for name, column in self.columns.items() if name in chosen}, self.rows)

    def plus(self, added: Mapping[str, Keys]) -> Table:
        """Return the table with further columns of the same length."""
        return Table({**self.columns, **added}, self.rows)

    def packed(self, names: Sequence[str]) -> Keys:
        """Return one number for each row, equal for rows with the same values in the columns named.

        Numbers of two tables can be compared for one or two columns only; more are ranked within this table.
        """
        if not names:
            return np.zeros(self.rows, np.int64)
        keys = self.columns[names[0]]
        for count, name in enumerate(names[1:]):
            keys = pack(ranks(keys) if count else keys, self.columns[name])
        return keys


UNIT: Final = Table({}, 1)
"""One solution that binds nothing: where a body begins."""


def ranks(values: Keys) -> Keys:
    """Return for each value its place among the distinct values, which fits half a key."""
    return np.searchsorted(distinct(values), values)


def distinct_rows(table: Table) -> Table:
    """Return the table with each row once."""
    names = list(table.columns)
    if not names:
        return Table({}, min(table.rows, 1))
    if len(names) == 1:
        values = distinct(table.columns[names[0]])
        return Table({names[0]: values}, values.size)
    if len(names) == 2:  # noqa: PLR2004 - two columns are one key
        keys = distinct(pack(table.columns[names[0]], table.columns[names[1]]))
        return Table({names[0]: keys >> 32, names[1]: keys & 0xFFFFFFFF}, keys.size)
    keys = table.packed(names)
    order = np.argsort(keys, kind="stable")
    ordered = keys[order]
    first = np.ones(ordered.size, bool)
    np.not_equal(ordered[1:], ordered[:-1], out=first[1:])
    return table if first.all() else table.take(np.sort(order[first]))


def concatenate(tables: Sequence[Table], names: Iterable[str]) -> Table:
    """Return tables, each of which has the columns named, one after the other."""
    if len(tables) == 1:
        return tables[0].keeping(names)
    columns = {name: np.concatenate([table.columns[name] for table in tables] or [EMPTY]) for name in names}
    return Table(columns, sum(table.rows for table in tables))


def among(values: Keys, ordered: Keys) -> NDArray[np.bool_]:
    """Return for each value whether the sorted array has it.

    For many values, a table with a bit of each hash excludes most of those missing, in a tenth of the time.
    """
    if ordered.size and values.size > max(_MANY, 4 * ordered.size):
        bits = ordered.size.bit_length() + 4
        seen = np.zeros(1 << bits, bool)
        seen[_hashes(ordered, bits)] = True
        present = seen[_hashes(values, bits)]
        present[present] = in_sorted(values[present], ordered)
        return present
    return in_sorted(values, ordered)


def _hashes(keys: Keys, bits: int) -> NDArray[np.uint64]:
    """Return the high bits of a product, by which neighbours are far apart (Knuth 1973, section 6.4)."""
    return (keys.view(np.uint64) * _FACTOR) >> np.uint64(64 - bits)


def positions(begin: NDArray[np.integer], end: NDArray[np.integer]) -> tuple[Keys, Keys]:
    """Return, for ranges from `begin` to before `end`, each number in them and the number of the range it is from.

    Raises `TooManyRowsError`.
    """
    counts = (end - begin).astype(np.int64)
    total = int(counts.sum())
    if total > 2 * CHUNK and counts.size > 1:
        raise TooManyRowsError(total)
    source = np.repeat(np.arange(counts.size), counts)
    # Each range counts on from its beginning: subtract where it starts in the result, add where it starts in the data.
    shift = begin - (np.cumsum(counts) - counts)
    return np.arange(total) + shift[source], source


def join(left: Table, right: Table) -> Table:
    """Join two tables on the columns that both have; duplicates stay."""
    shared = sorted(left.columns.keys() & right.columns.keys())
    if len(shared) > 2:  # noqa: PLR2004 - two columns are one key; more are ranked together
        both = concatenate([left.keeping(shared), right.keeping(shared)], shared).packed(shared)
        left_keys, right_keys = both[: left.rows], both[left.rows :]
    else:
        left_keys, right_keys = left.packed(shared), right.packed(shared)
    order = np.argsort(right_keys, kind="stable")
    ordered = right_keys[order]
    begin = np.searchsorted(ordered, left_keys)
    end = np.searchsorted(ordered, left_keys, side="right")
    places, source = positions(begin, end)
    added = {name: column[order[places]] for name, column in right.columns.items() if name not in shared}
    return left.take(source).plus(added)
