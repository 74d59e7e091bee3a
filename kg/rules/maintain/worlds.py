"""The data at one moment, and the triples added or removed between two moments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kg.rules.engine.facts import Facts


@dataclass(slots=True)
class World:
    """The data at one moment: the asserted triples, and all triples."""

    asserted: Facts
    known: Facts

    def copy(self) -> World:
        """Return a world that can be changed by itself."""
        return World(self.asserted.copy(), self.known.copy())


@dataclass(slots=True)
class Delta:
    """Triples added or removed: among the asserted ones, and among all; `patterns` has those of all."""

    asserted: Facts
    known: Facts
    patterns: set[int]
