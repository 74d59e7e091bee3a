"""Sets of triples taken together; each costs in proportion to the smaller one, but for copies of what is changed."""

from __future__ import annotations

from kg.rules.engine.facts import Facts, difference, intersection

__all__ = ["absorb", "common", "lacking", "take_out"]


def common(facts: Facts, others: Facts) -> Facts:
    """Return the triples that both have."""
    return _each(facts, others, keep=True)


def lacking(facts: Facts, others: Facts) -> Facts:
    """Return the triples of `facts` that `others` lack."""
    return _each(facts, others, keep=False)


def _each(facts: Facts, others: Facts, *, keep: bool) -> Facts:
    found = Facts()
    for predicate, keys in facts:
        known = others.keys(predicate)
        found.replace(predicate, intersection(keys, known) if keep else difference(keys, known))
    return found


def absorb(facts: Facts, others: Facts) -> None:
    """Add triples, some of which may be there already."""
    for predicate, keys in others:
        facts.add(predicate, keys)


def take_out(facts: Facts, others: Facts) -> None:
    """Take triples away, some of which may not be there."""
    for predicate, keys in others:
        facts.remove(predicate, keys)
