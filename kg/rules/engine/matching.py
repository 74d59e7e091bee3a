"""Joins a table with the triples that an atom matches."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Final, Self

import numpy as np

from kg.rules.engine.facts import Facts, Keys, pack, unpack
from kg.rules.engine.tables import CHUNK, Table, TooManyRowsError, among, concatenate, positions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from kg.rules.engine.plan import Match, Node

_LOW: Final = 0xFFFFFFFF
_MANY: Final = 512
_DENSE: Final = 8


@dataclass(frozen=True, slots=True)
class Pairs:
    """The triples of one predicate as an atom sees them."""

    facts: Facts
    predicate: int
    terms: int
    """How many terms the dictionary has."""

    def keys(self, *, by_object: bool) -> Keys:
        """Return the pairs sorted by subject or by object."""
        return self.facts.by_object(self.predicate) if by_object else self.facts.keys(self.predicate)

    def ranges(self, needles: Keys, *, by_object: bool) -> tuple[NDArray[np.integer], NDArray[np.integer]]:
        """Return where the pairs of each needle begin and end among the keys."""
        keys = self.keys(by_object=by_object)
        many = needles.size > _MANY and needles.size * _DENSE > keys.size + self.terms
        if many or self.facts.has_starts(self.predicate, self.terms, by_object=by_object):
            starts = self.facts.starts(self.predicate, self.terms, by_object=by_object)
            return starts[needles], starts[needles + 1]
        return keys.searchsorted(needles << 32), keys.searchsorted((needles + 1) << 32)

    def slice(self, term: int, *, by_object: bool) -> Keys:
        """Return the other ends of the pairs of one term, sorted."""
        return self.facts.pairs_of(self.predicate, term, by_object=by_object) & _LOW


@dataclass(frozen=True, slots=True)
class Reading:
    """How an atom is read: from `facts`, over a dictionary of so many `terms`, for the columns `needed` afterwards."""

    facts: Facts
    terms: int
    needed: frozenset[str]
    hidden: frozenset[int] = frozenset()
    """Predicates that a variable predicate does not match."""

    def pairs(self, predicate: int) -> Pairs:
        """Return the triples of one predicate."""
        return Pairs(self.facts, predicate, self.terms)


def match(table: Table, atom: Match, reading: Reading) -> Table:
    """Return the table joined with the triples that match an atom; new columns only where they are needed."""
    needed = reading.needed
    if isinstance(atom.predicate, int):
        return _pairs(table, atom.subject, atom.object, reading.pairs(atom.predicate), needed)
    parts = [part for part in _by_predicate(table, atom, reading) if part.rows]
    names = table.columns.keys() | (atom.names & needed)
    return concatenate(parts, names)


def _by_predicate(table: Table, atom: Match, reading: Reading) -> Iterator[Table]:
    """Yield the join with each predicate that a variable predicate may be."""
    name = str(atom.predicate)
    bound = table.columns.get(name)
    if bound is not None:
        order = np.argsort(bound, kind="stable")
        ordered = bound[order]
    probe = _Probe.of(table, atom, reading) if bound is None else None
    for predicate in sorted(reading.facts.predicates):
        if predicate in reading.hidden:
            continue
        part = table
        if bound is not None:
            begin, end = np.searchsorted(ordered, [predicate, predicate + 1])
            if begin == end:
                continue
            part = table.take(order[begin:end])
        pairs = reading.pairs(predicate)
        if probe is not None and pairs.keys(by_object=False).size < _DENSE * table.rows:
            result = probe.joined(pairs)
            result = result.plus({name: np.full(result.rows, predicate, np.int64)})
        else:
            if bound is None:
                part = table.plus({name: np.full(table.rows, predicate, np.int64)})
            result = _pairs(part, atom.subject, atom.object, pairs, reading.needed)
        if bound is None and name not in reading.needed:
            result = result.keeping(result.columns.keys() - {name})
        yield result


@dataclass(frozen=True, slots=True)
class _Probe:
    """A table to be joined with the pairs of many predicates by one end: each pair is looked up in the table.

    That takes time in proportion to the pairs; to look up each row among them, in proportion to rows and predicates.
    """

    table: Table
    order: Keys
    ordered: Keys
    present: NDArray[np.bool_]
    by_object: bool
    free: str

    @classmethod
    def of(cls, table: Table, atom: Match, reading: Reading) -> Self | None:
        """Return the table prepared for an atom; None where not exactly one end is a column of the table."""
        ends = (atom.subject, atom.object)
        bound = [isinstance(end, str) and end in table.columns for end in ends]
        if sum(bound) != 1 or not all(isinstance(end, str) for end in ends) or atom.predicate in ends:
            return None
        column = table.columns[str(ends[bound.index(True)])]
        order = np.argsort(column, kind="stable")
        present = np.zeros(reading.terms, bool)
        present[column] = True
        return cls(table, order, column[order], present, bound[1], str(ends[bound.index(False)]))

    def joined(self, pairs: Pairs) -> Table:
        """Return the join with the pairs of a predicate, with a column for the other end."""
        others, values = unpack(pairs.keys(by_object=False))
        if not self.by_object:
            others, values = values, others
        met = np.flatnonzero(self.present[values])
        values = values[met]
        begin = np.searchsorted(self.ordered, values)
        places, source = positions(begin, np.searchsorted(self.ordered, values, side="right"))
        return self.table.take(self.order[places]).plus({self.free: others[met][source]})


def _pairs(table: Table, subject: Node, value: Node, pairs: Pairs, needed: frozenset[str]) -> Table:
    """Join with the pairs of one predicate."""
    free_subject = isinstance(subject, str) and subject not in table.columns
    free_value = isinstance(value, str) and value not in table.columns
    if free_subject and free_value:
        subjects, objects = unpack(pairs.keys(by_object=False))
        if subject == value:
            subjects = objects = subjects[subjects == objects]
        return _cross(table, {str(subject): subjects, str(value): objects}, subjects.size, needed)
    if free_value:
        return _one_free(table, (subject, str(value)), pairs, needed, by_object=False)
    if free_subject:
        return _one_free(table, (value, str(subject)), pairs, needed, by_object=True)
    return _none_free(table, subject, value, pairs)


def _cross(table: Table, columns: dict[str, Keys], size: int, needed: frozenset[str]) -> Table:
    """Return each row of the table with each row of the columns; those without a needed column count once."""
    selected = {name: column for name, column in columns.items() if name in needed}
    if not selected:
        return table if size else table.take(slice(0, 0))
    if table.rows == 1 and not table.columns:
        return Table(selected, size)
    if table.rows > 1 and table.rows * size > 2 * CHUNK:
        raise TooManyRowsError(table.rows * size)
    source = np.repeat(np.arange(table.rows), size)
    return table.take(source).plus({name: np.tile(column, table.rows) for name, column in selected.items()})


def _one_free(table: Table, ends: tuple[Node, str], pairs: Pairs, needed: frozenset[str], *, by_object: bool) -> Table:
    """Join where one end is known and the other is a new column."""
    bound, free = ends
    if isinstance(bound, int):
        values = pairs.slice(bound, by_object=by_object)
        return _cross(table, {free: values}, values.size, needed)
    begin, end = pairs.ranges(table.columns[bound], by_object=by_object)
    if free not in needed:
        return table.take(end > begin)
    places, source = positions(begin, end)
    return table.take(source).plus({free: pairs.keys(by_object=by_object)[places] & _LOW})


def _none_free(table: Table, subject: Node, value: Node, pairs: Pairs) -> Table:
    """Keep the rows whose pair is there."""
    if isinstance(subject, str) and isinstance(value, str):
        return table.take(among(pack(table.columns[subject], table.columns[value]), pairs.keys(by_object=False)))
    if isinstance(subject, str):
        return table.take(among(table.columns[subject], pairs.slice(int(value), by_object=True)))
    if isinstance(value, str):
        return table.take(among(table.columns[value], pairs.slice(subject, by_object=False)))
    there = among(np.array([(subject << 32) | value], np.int64), pairs.keys(by_object=False))
    return table if there[0] else table.take(slice(0, 0))


def joined(table: Table, atom: Match, reading: Reading) -> tuple[str, NDArray[np.integer]] | None:
    """Count for each row the pairs that an atom joins it with, one of whose ends is a column of the table.

    Return the column that the other end becomes, and the counts; None for another atom.
    """
    if not (isinstance(atom.subject, str) and isinstance(atom.predicate, int) and isinstance(atom.object, str)):
        return None
    subjects, objects = table.columns.get(atom.subject), table.columns.get(atom.object)
    if (subjects is None) == (objects is None):
        return None
    bound, free, by_object = (objects, atom.subject, True) if subjects is None else (subjects, atom.object, False)
    begin, end = reading.pairs(atom.predicate).ranges(bound, by_object=by_object)  # type: ignore[arg-type]  # one is known
    return free, end - begin


def spread(atom: Match, facts: Facts, *, subject: bool, value: bool, predicate: bool) -> tuple[float, float]:
    """Estimate how many rows come of one where these nodes of an atom are known, and how many of all at the most."""
    if not isinstance(atom.predicate, int):
        if subject and value:
            return 1.0, inf
        size = float(len(facts))
        size = max(size, 1.0) ** 0.5 if subject or value else size
        return (size if predicate else 2 * size), inf
    total = facts.keys(atom.predicate).size
    if not total:
        return 0.0, 0.0
    if subject and value:
        return 0.5, total * 0.5
    if not subject and not value:
        return float(total), inf
    bound = atom.subject if subject else atom.object
    if isinstance(bound, int):
        return float(facts.pairs_of(atom.predicate, bound, by_object=value).size), inf
    return facts.fan_out(atom.predicate, by_object=value), inf
