"""Operations on two sets of triples; apart from copies, the cost is in proportion to the smaller set."""

from __future__ import annotations

from kg.rules.engine.facts import Facts, intersection

__all__ = ["absorb", "common", "lacking", "take_out"]


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
