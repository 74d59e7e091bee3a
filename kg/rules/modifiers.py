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

_INTEGER: Final = b'"^^<http://www.w3.org/2001/XMLSchema#integer>'


def modified(question: Question, solutions: Table, dictionary: Dictionary) -> Table | None:
    """Return the rows of an answer; None where it has an order of terms that only the store knows."""
    table = _counted(question, solutions, dictionary) if question.grouped else solutions
    table = Table({name: table.columns[name] for name in question.shown}, table.rows)
    if question.distinct:
        table = distinct_rows(table)
    if not question.order:
        return table.take(slice(question.limit))
    return _ordered(table, question.order, question.limit, dictionary)


def _counted(question: Question, table: Table, dictionary: Dictionary) -> Table:
    """Return a row for each group of solutions; without keys all are one group, be there none."""
    if question.keys:
        _, first, group = np.unique(table.packed(question.keys), return_index=True, return_inverse=True)
        columns, size = {key: table.columns[key][first] for key in question.keys}, first.size
    else:
        columns, size, group = {}, 1, np.zeros(table.rows, np.int64)
    for name, counted in question.shown.items():
        if counted is not None:
            among = group if counted == "*" else group[table.columns[counted] != 0]
            numbers, places = np.unique(np.bincount(among, minlength=size), return_inverse=True)
            columns[name] = dictionary.intern_all(spell(Literal(number)) for number in numbers.tolist())[places]
    return Table(columns, size)


def _ordered(
    table: Table, order: Sequence[tuple[str, bool]], limit: int | None, dictionary: Dictionary
) -> Table | None:
    """Return sorted rows. With a limit only those are sorted that the first column leaves among the first."""
    keys: list[Keys] = []
    for name, down in order:
        ranks = _ranks(table.columns[name], dictionary)
        if ranks is None:
            return None
        keys.append(-ranks if down else ranks)
        if len(keys) == 1 and limit and table.rows > limit:
            best = keys[0] <= np.partition(keys[0], limit - 1)[limit - 1]
            table, keys = table.take(best), [keys[0][best]]
    return table.take(np.lexsort(keys[::-1])[:limit])


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
    result: Keys = ranks[places]
    return result


def _values(spelt: Sequence[bytes]) -> Sequence[bytes] | Sequence[int] | None:
    """Return what terms are compared by."""
    if all(one.startswith(b"<") and not one.startswith(b"<<") for one in spelt):
        return [one[1:-1] for one in spelt]
    if all(one.startswith(b'"') and one.endswith(b'"') for one in spelt):
        return [str(getattr(of_spelling(one), "value", "")).encode() if b"\\" in one else one[1:-1] for one in spelt]
    if all(one.endswith(_INTEGER) for one in spelt):
        return [int(one[1 : -len(_INTEGER)]) for one in spelt]
    return None
