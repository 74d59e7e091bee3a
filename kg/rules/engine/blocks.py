"""Blocks of SPARQL that were not decomposed: evaluated by the store's engine over the triples they may read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import pyoxigraph as ox

from kg.errors import RuleError
from kg.rules.columns import lines
from kg.rules.engine.tables import Table
from kg.rules.sparql import spelling
from kg.store.terms import spell

if TYPE_CHECKING:
    from kg.rules.engine.facts import Facts, Keys
    from kg.rules.engine.limits import Clock
    from kg.rules.engine.plan import Block
    from kg.rules.engine.terms import Dictionary

_REMEMBERED: Final = 64


class Blocks:
    """Evaluates blocks; the last solutions are cached until the triples that they read change."""

    def __init__(self, dictionary: Dictionary) -> None:
        self._dictionary = dictionary
        self._cache: dict[tuple[str, tuple[str, ...]], tuple[list[tuple[int, Keys]], Table]] = {}

    def solutions(self, step: Block, facts: Facts, clock: Clock, hidden: frozenset[int]) -> Table:
        """Return the solutions of a block; 0 where a variable is unbound.

        One that may read anything does not see the predicates `hidden`.
        """
        predicates = set(facts.predicates)
        if step.block.reads is None:
            predicates -= hidden
        else:
            predicates &= {self._dictionary.intern_term(predicate) for predicate in step.block.reads}
        read = [(predicate, facts.keys(predicate)) for predicate in sorted(predicates)]
        name = step.block.text, tuple(column for _, column in step.columns)
        cached = self._cache.get(name)
        if cached is not None and _same(cached[0], read):
            return cached[1]
        clock.check()
        table = self._evaluate(step, facts, [predicate for predicate, _ in read])
        if len(self._cache) >= _REMEMBERED:
            self._cache.pop(next(iter(self._cache)))
        self._cache[name] = read, table
        return table

    def _evaluate(self, step: Block, facts: Facts, predicates: list[int]) -> Table:
        store = ox.Store()
        # Parsed here, since the store's own loading gives blank nodes other labels.
        text = b"".join(lines(facts, self._dictionary, predicates))
        store.bulk_extend(ox.parse(text, ox.RdfFormat.N_TRIPLES))
        shown = " ".join(spelling(variable) for variable in step.block.variables)
        rows: list[list[int]] = []
        try:
            for solution in store.query(f"SELECT {shown or '*'} {{ {step.block.text} }}"):  # type: ignore[union-attr]  # a SELECT gives solutions
                terms = [solution[index] for index in range(len(step.columns))]
                rows.append([0 if term is None else self._dictionary.intern(spell(term)) for term in terms])
        except RuntimeError as error:  # a literal in a variable that is the subject of a triple term
            message = f"the store's engine cannot evaluate a part of the rule: {error}"
            hint = "Restrict the variables of triple terms, such as FILTER(!isLiteral(?x)), or leave VALUES out."
            raise RuleError("KG209", message, place=step.block.place, hint=hint) from error
        values = np.array(rows, np.int64).reshape(len(rows), len(step.columns))
        columns = {column: values[:, index].copy() for index, (_, column) in enumerate(step.columns)}
        return Table(columns, len(rows))


def _same(cached: list[tuple[int, Keys]], read: list[tuple[int, Keys]]) -> bool:
    """Whether the very arrays that were read are there still; arrays are never changed."""
    return len(cached) == len(read) and all(
        one[0] == other[0] and one[1] is other[1] for one, other in zip(cached, read, strict=True)
    )
