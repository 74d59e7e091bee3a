"""Sets of triples taken together; each costs in proportion to the smaller one, but for copies of what is changed."""

from __future__ import annotations

from kg.rules.engine.facts import Facts, intersection

__all__ = ["absorb", "common", "lacking", "take_out"]


def common(facts: Facts, others: Facts) -> Facts:
    """Return the triples that both have."""
    found = Facts()
    for predicate, keys in facts:
        found.replace(predicate, intersection(keys, others.keys(predicate)))
    return found


def lacking(facts: Facts, others: Facts) -> Facts:
    """Return the triples of `facts` that `others` lack."""
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
