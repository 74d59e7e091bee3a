"""The data at one moment, and what comes or goes between two moments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kg.rules.engine.facts import Facts

__all__ = ["Delta", "World"]


@dataclass(slots=True)
class World:
    """The data at one moment: what is asserted, and everything that is asserted or inferred."""

    asserted: Facts
    known: Facts

    def copy(self) -> World:
        """Return a world that can be changed by itself."""
        return World(self.asserted.copy(), self.known.copy())


@dataclass(slots=True)
class Delta:
    """Triples that came or that went: from what is asserted, and from everything; `patterns` has those of all."""

    asserted: Facts
    known: Facts
    patterns: set[int]
