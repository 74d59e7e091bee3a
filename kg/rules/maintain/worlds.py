"""The data at one moment, and the triples added or removed between two moments."""

from __future__ import annotations

from dataclasses import dataclass

from kg.rules.engine.facts import Facts, intersection

__all__ = ["Delta", "World", "absorb", "common", "lacking", "take_out"]


def common(facts: Facts, others: Facts) -> Facts:
    """Return the intersection."""
    found = Facts()
    for predicate, keys in facts:
        found.replace(predicate, intersection(keys, others.keys(predicate)))
    return found


def lacking(facts: Facts, others: Facts) -> Facts:
    """Return the triples of `facts` that are not in `others`."""
    found = Facts()
    for predicate, keys in facts:
        found.replace(predicate, others.missing(predicate, keys))
    return found


def absorb(facts: Facts, others: Facts) -> None:
    """Add triples, some of which may be there already."""
    for predicate, keys in others:
        facts.add(predicate, keys)


def take_out(facts: Facts, others: Facts) -> None:
    """Remove triples, some of which may be absent."""
    for predicate, keys in others:
        facts.remove(predicate, keys)


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
