"""Possible classes of the terms in a query, and properties that fit them, from the statistics of the store."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.query.completion.outline import TYPE, Pattern, Step

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.query.completion.statistics import Statistics

_SHARE: Final = 0.1
"""Classes with a smaller share of a property's values than this, relative to the most frequent class, are ignored."""


def asserted(term: str, patterns: Iterable[Pattern]) -> list[str]:
    """Return the classes that the query asserts for a term, the last one first."""
    kind = (Step(TYPE, inverse=False),)
    kinds = (each.object for each in patterns if each.subject == term and each.path == kind)
    return list(reversed([each for each in dict.fromkeys(kinds) if not each.startswith(("?", "_:"))]))


def classes(term: str, patterns: Iterable[Pattern], statistics: Statistics) -> list[str]:
    """Return the possible classes of a term: those asserted, else those compatible with all of its patterns."""
    patterns = list(patterns)
    asserted_classes = asserted(term, patterns)
    if asserted_classes:
        return asserted_classes
    options = []
    for each in patterns:
        if each.subject == term and each.path and each.path[0].iri != TYPE:
            first = each.path[0]
            options.append(_to(Step(first.iri, not first.inverse), statistics))
        if each.object == term and each.path and each.path[-1].iri != TYPE:
            options.append(_to(each.path[-1], statistics))
    options = [each for each in options if each]
    if not options:
        return []
    common = set(options[0]).intersection(*options[1:]) or set().union(*options)
    return sorted(common)


def behind(step: Step, statistics: Statistics) -> list[str]:
    """Return the classes of the values that a step of a path leads to."""
    return sorted(_to(step, statistics))


def _to(step: Step, statistics: Statistics) -> set[str]:
    if step.iri is None:
        return set()
    if step.inverse:
        return {kind for kind, used in statistics.used.items() if step.iri in used}
    return _values(step.iri, statistics)


def _values(iri: str, statistics: Statistics) -> set[str]:
    numbers = statistics.leads.get(iri, {})
    least = max(numbers.values(), default=0) * _SHARE
    return {kind for kind, number in numbers.items() if number >= least}


def fitting(kinds: Iterable[str], statistics: Statistics) -> Mapping[str, tuple[int, str]]:
    """Return the properties of some classes, each with its number of instances and the class with the most."""
    by_property: dict[str, tuple[int, str]] = {}
    for kind in kinds:
        for iri, number in statistics.used.get(kind, {}).items():
            if iri not in by_property or number > by_property[iri][0]:
                by_property[iri] = (number, kind)
    return by_property


def leading(kinds: Iterable[str], statistics: Statistics) -> Mapping[str, tuple[int, str]]:
    """Return the properties whose values are of some classes, with the number of triples and one of the classes."""
    wanted = list(kinds)
    by_property = {}
    for iri in statistics.leads:
        to = next((kind for kind in wanted if kind in _values(iri, statistics)), None)
        if to is not None:
            by_property[iri] = (statistics.properties.get(iri, 0), to)
    return by_property
