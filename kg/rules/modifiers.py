"""What a SELECT does with its solutions: counts, order and limit (SPARQL 1.1, sections 11 and 15), over columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from pyoxigraph import Literal

from kg.rules.engine.tables import Table, distinct_rows
from kg.store.terms import of_spelling, spell

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.engine.facts import Keys
    from kg.rules.engine.terms import Dictionary
    from kg.rules.questions import Question

__all__ = ["modified"]

_INTEGER: Final = b'"^^<http://www.w3.org/2001/XMLSchema#integer>'


def modified(asked: Question, solutions: Table, dictionary: Dictionary) -> Table | None:
    """Return the rows of an answer; None where it has an order of terms that only the store knows."""
    table = _counted(asked, solutions, dictionary) if asked.grouped else solutions
    table = Table({name: table.columns[name] for name in asked.shown}, table.rows)
    if asked.distinct:
        table = distinct_rows(table)
    if not asked.order:
        return table.take(slice(asked.limit))
    return _ordered(table, asked.order, asked.limit, dictionary)


def _counted(asked: Question, table: Table, dictionary: Dictionary) -> Table:
    """Return a row for each group of solutions; without keys all are one group, be there none."""
    if asked.keys:
        _, first, group = np.unique(table.packed(asked.keys), return_index=True, return_inverse=True)
        columns, size = {key: table.columns[key][first] for key in asked.keys}, first.size
    else:
        columns, size, group = {}, 1, np.zeros(table.rows, np.int64)
    for name, counted in asked.shown.items():
        if counted is not None:
            among = group if counted == "*" else group[table.columns[counted] != 0]
            numbers, places = np.unique(np.bincount(among, minlength=size), return_inverse=True)
            columns[name] = dictionary.intern_all(spell(Literal(number)) for number in numbers.tolist())[places]
    return Table(columns, size)


def _ordered(
    table: Table, order: Sequence[tuple[str, bool]], limit: int | None, dictionary: Dictionary
) -> Table | None:
    """Return sorted rows. With a limit only those are sorted that the first column leaves among the first."""
    found: list[Keys] = []
    for name, down in order:
        ranks = _ranks(table.columns[name], dictionary)
        if ranks is None:
            return None
        found.append(-ranks if down else ranks)
        if len(found) == 1 and limit and table.rows > limit:
            kept = found[0] <= np.partition(found[0], limit - 1)[limit - 1]
            table, found = table.take(kept), [found[0][kept]]
    return table.take(np.lexsort(found[::-1])[:limit])


def _ranks(column: Keys, dictionary: Dictionary) -> Keys | None:
    """Return for each term its place in the order; None unless all are IRIs, plain strings or integers."""
    terms, places = np.unique(column, return_inverse=True)
    spelt = dictionary.spellings(terms[terms != 0])
    values = _values(spelt)
    if values is None:
        return None
    numbers = {value: number for number, value in enumerate(sorted(set[Any](values)), 1)}
    # What is unbound comes first.
    ranks = np.array([0] * int(terms.size - len(values)) + [numbers[value] for value in values], np.int64)
    found: Keys = ranks[places]
    return found


def _values(spelt: Sequence[bytes]) -> Sequence[bytes] | Sequence[int] | None:
    """Return what terms are compared by."""
    if all(one.startswith(b"<") and not one.startswith(b"<<") for one in spelt):
        return [one[1:-1] for one in spelt]
    if all(one.startswith(b'"') and one.endswith(b'"') for one in spelt):
        return [str(getattr(of_spelling(one), "value", "")).encode() if b"\\" in one else one[1:-1] for one in spelt]
    if all(one.endswith(_INTEGER) for one in spelt):
        return [int(one[1 : -len(_INTEGER)]) for one in spelt]
    return None
