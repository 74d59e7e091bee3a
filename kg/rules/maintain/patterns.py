"""Find the rules that a change can reach, by patterns of the triples that rules read and derive.

A pattern is `predicate << 32 | object`, where 0 stands for any object; `ANY` is that of all triples. Of some hundred
strata a small change reaches few. Disjoint sets of patterns exclude the others without a join.

The data at one moment, and the triples added or removed between two moments.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from kg.rules.engine.facts import Facts, distinct
from kg.rules.engine.tables import among

ANY: Final = 0
_LOW: Final = 0xFFFFFFFF


@dataclass(slots=True)
class World:
    """The data at one moment: the asserted triples, and all triples."""

    asserted: Facts
    facts: Facts

    def copy(self) -> World:
        """Return a world that can be changed by itself."""
        return World(self.asserted.copy(), self.facts.copy())


@dataclass(slots=True)
class Delta:
    """Triples added or removed: among the asserted ones, and among all; `patterns` has those of all."""

    asserted: Facts
    facts: Facts
    patterns: set[int]


def pattern(predicate: object, value: object) -> int:
    """Return the pattern of an atom; a position without a term matches any."""
    if not isinstance(predicate, int):
        return ANY
    return predicate << 32 | (value if isinstance(value, int) else 0)


class Patterns:
    """The patterns of some rules."""

    def __init__(self, patterns: Iterable[int]) -> None:
        objects: defaultdict[int, set[int]] = defaultdict(set)
        for one in patterns:
            if one & _LOW:
                objects[one >> 32].add(one & _LOW)
        self._objects = {predicate: np.array(sorted(named), np.int64) for predicate, named in objects.items()}

    def of(self, facts: Facts) -> set[int]:
        """Return the patterns of some triples, with objects only where rules distinguish them."""
        result: set[int] = set()
        for predicate, keys in facts:
            result.update((ANY, predicate << 32))
            named = self._objects.get(predicate)
            if named is not None:
                there = named[among(named, distinct(keys & _LOW))]
                result.update(((predicate << 32) | there).tolist())
        return result
