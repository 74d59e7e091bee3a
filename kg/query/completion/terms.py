"""Candidates from the store: classes, properties, values, graphs, and prefixes of names."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import msgspec
from pyoxigraph import Literal, NamedNode

from kg.query.completion.outline import TYPE, Pattern, Slot, Step
from kg.query.completion.site import Candidate, Form, Site
from kg.syntax.lexer import Kind
from kg.syntax.names import PREFIXES, WELL_KNOWN, shorten

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from kg.query.completion.statistics import SnapshotCache, Statistics


def prefixes(site: Site) -> Iterator[Candidate]:
    """Yield the prefixes of prefixed names."""
    if site.typed.form is not Form.NAME:
        for prefix, namespace in site.prefixes.items():
            name = prefix + ":"
            yield Candidate(name, name, "prefix", name, namespace, rank=4, prefix=prefix)


def declarations(site: Site) -> Iterator[Candidate]:
    """Yield declarations after PREFIX; well-known prefixes that the store does not use come last."""
    for rank, namespaces_by_prefix in ((0, site.prefixes), (1, WELL_KNOWN)):
        for prefix, namespace in namespaces_by_prefix.items():
            if prefix not in site.before.prefixes and (rank == 0 or prefix not in site.prefixes):
                yield Candidate(prefix + ":", f"{prefix}: <{namespace}>", "prefix", prefix, namespace, rank=rank)


def namespaces(site: Site) -> Iterator[Candidate]:
    """Yield the namespace of the prefix that is being declared, or of all prefixes if it is unknown."""
    by_prefix = {**WELL_KNOWN, **site.prefixes}
    declared = site.before.frame.subject
    for prefix, namespace in by_prefix.items():
        if declared not in by_prefix or prefix == declared:
            yield Candidate(f"<{namespace}>", f"<{namespace}>", "prefix", namespace, prefix + ":")


def properties(site: Site) -> Iterator[Candidate]:
    """Yield the properties that fit the subject, with their numbers of instances, then all others."""
    frame = site.before.frame
    fitting_ones: Mapping[str, tuple[int, str]] = {}
    if not frame.subject.startswith(("?", "_:")) and not frame.steps and frame.subject:
        fitting_ones = {iri: (number, "") for iri, number in of_iri(site.cache, frame.subject).items()}
    else:
        kinds = _kinds_here(site)
        fitting_ones = leading(kinds, site.statistics) if frame.inverse else fitting(kinds, site.statistics)
    for iri, (number, kind) in fitting_ones.items():
        yield _property(site, iri, number, _share(site, number, kind, inverse=frame.inverse), 0)
    if not frame.steps and not frame.inverse:
        rank = 1 if asserted(frame.subject, site.whole.patterns) else -1
        yield Candidate("a", "a ", "keyword", "a", "rdf:type", None, "the class of the subject", rank)
    for iri, number in site.statistics.properties.items():
        if iri not in fitting_ones:
            yield _property(site, iri, number, f"{number:,} triples", 2)
    yield from prefixes(site)


def _kinds_here(site: Site) -> list[str]:
    frame = site.before.frame
    if frame.steps:
        last = frame.steps[-1]
        return behind(Step(last.iri, last.inverse), site.statistics)
    return classes(frame.subject, site.whole.patterns, site.statistics)


def _share(site: Site, number: int, kind: str, *, inverse: bool) -> str:
    if inverse or not kind:
        return f"{number:,} triples"
    return f"{number:,} of {site.statistics.classes.get(kind, number):,} {site.short(kind)}"


def _property(site: Site, iri: str, number: int, detail: str, rank: int) -> Candidate:
    label = site.short(iri)
    return Candidate(label, label, "property", label, detail, number, site.comment(iri), rank, prefix=_prefix(label))


def _prefix(label: str) -> str:
    return "" if label.startswith("<") else label.partition(":")[0]


def values_here(site: Site) -> Iterator[Candidate]:
    """Yield the terms of the store that are possible objects or values."""
    frame = site.before.frame
    if frame.slot is Slot.DATA:
        column = min(frame.column, len(frame.columns) - 1)
        if column >= 0:
            yield from _of_variable(site, frame.columns[column])
    elif frame.slot is Slot.EXPRESSION:
        yield from compared_values(site)
    elif frame.slot is Slot.OBJECT and frame.steps and frame.steps[-1].iri is not None:
        step = frame.steps[-1]
        if step.iri == TYPE:
            yield from _classes(site)
        elif not step.inverse:
            subject = frame.subject if len(frame.steps) == 1 else ""
            yield from _values(site, step.iri or "", asserted(subject, site.whole.patterns))


def compared_values(site: Site) -> Iterator[Candidate]:
    """Yield the values of a variable in a comparison."""
    before = site.typed.before
    if len(before) > 1 and before[-1].text in {"=", "!="} and before[-2].kind is Kind.VARIABLE:
        yield from _of_variable(site, "?" + before[-2].text[1:])


def _of_variable(site: Site, variable: str) -> Iterator[Candidate]:
    for pattern in site.whole.patterns:
        if pattern.object == variable and pattern.path and not pattern.path[-1].inverse:
            iri = pattern.path[-1].iri
            if iri == TYPE:
                yield from _classes(site)
            elif iri is not None:
                subject = pattern.subject if len(pattern.path) == 1 else ""
                yield from _values(site, iri, asserted(subject, site.whole.patterns))
            return


def _classes(site: Site) -> Iterator[Candidate]:
    """Yield the classes; those compatible with the other patterns of the subject come first."""
    others = [each for each in site.whole.patterns if each.path and each.path[-1].iri != TYPE]
    fits = set(classes(site.before.frame.subject, others, site.statistics))
    for iri, number in site.statistics.classes.items():
        label = site.short(iri)
        rank = 0 if iri in fits or not fits else 2
        detail = f"{number:,} instances"
        yield Candidate(label, label, "class", label, detail, number, site.comment(iri), rank, prefix=_prefix(label))


_PLENTY: Final = 400_000
"""Values of properties with more triples are not offered, because the query would take seconds."""


def _values(site: Site, iri: str, kinds: list[str]) -> Iterator[Candidate]:
    number = site.statistics.properties.get(iri, 0)
    if not 0 < number <= _PLENTY:
        return
    literal = iri in site.statistics.literal
    if not literal and site.typed.form is Form.STRING:
        return
    if kinds and kinds[0] not in site.statistics.classes:
        # The cache would otherwise grow with every class name that is typed.
        return
    offered = values(site.cache, iri, kinds[0] if kinds else None, literal=literal)
    for value in offered.holding(site.typed.text.removeprefix("<")):
        label = value.text if literal or value.written.startswith("<") else value.written
        prefix = "" if literal else _prefix(value.written)
        detail = value.written if label != value.written and not literal else ""
        yield Candidate(label, value.written, "value", value.text, detail, value.count, prefix=prefix)


def graph_names(site: Site) -> Iterator[Candidate]:
    """Yield the named graphs."""
    for one in graphs(site.cache).holding(site.typed.text.removeprefix("<")):
        yield Candidate(one.written, one.written, "graph", one.text, prefix=_prefix(one.written))


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
    return _ground_terms(step.iri, statistics)


def _ground_terms(iri: str, statistics: Statistics) -> set[str]:
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
        to = next((kind for kind in wanted if kind in _ground_terms(iri, statistics)), None)
        if to is not None:
            by_property[iri] = (statistics.properties.get(iri, 0), to)
    return by_property


_MOST: Final = 50_000
"""Largest number of cached values of a property; the most frequent ones are cached."""
_IRI: Final = re.compile(r"[A-Za-z][\w+.-]*:[^\x00-\x20<>\"{}|^`\\]*", re.ASCII)
"""Valid text between angle brackets; an unfinished query may contain any text as an IRI."""
_XSD: Final = PREFIXES["xsd"]
_BARE: Final = frozenset({_XSD + "integer", _XSD + "boolean", _XSD + "decimal"})


class Value(msgspec.Struct, frozen=True, array_like=True):
    """A term in SPARQL syntax (`written`), its label or text, and the number of its occurrences."""

    written: str
    text: str
    count: int


class Values(NamedTuple):
    """Values, the most frequent first, and their texts in lower case."""

    values: list[Value]
    lower: list[str]

    def holding(self, typed: str) -> Iterator[Value]:
        """Yield values whose text contains `typed`, up to the number of candidates; if there are few values, all."""
        wanted = typed.lower()
        if len(self.values) <= _FEW:
            yield from self.values
            return
        matches = (value for value, lower in zip(self.values, self.lower, strict=True) if wanted in lower)
        yield from islice(matches, _OFFERED)


_FEW: Final = 1000
"""Up to this number, all values are candidates and the matcher ranks them."""
_OFFERED: Final = 500
_OF_CLASS: Final = "?s a <%s> ."
_COUNTED: Final = "SELECT ?o (COUNT(*) AS ?n) { %s ?s <%s> ?o } GROUP BY ?o"
_LABELLED: Final = "SELECT ?o ?n ?l { { %s } OPTIONAL { ?o rdfs:label ?l } }"
_PROPERTIES: Final = "SELECT ?p (COUNT(*) AS ?n) { <%s> ?p ?o } GROUP BY ?p"


def values(cache: SnapshotCache, iri: str, kind: str | None, *, literal: bool) -> Values:
    """Return the values of the property `iri`, of instances of `kind` or of any subject."""

    def make() -> list[Value]:
        if not all(_IRI.fullmatch(each) for each in (iri, kind) if each is not None):
            return []
        counted = _COUNTED % (_OF_CLASS % kind if kind else "", iri)
        rows: Any = cache.snapshot.query(counted if literal else _LABELLED % counted, prefixes=PREFIXES)
        by_term = {
            row[0]: _value(row[0], int(row[1].value), None if literal else row[2])
            for row in rows
            if isinstance(row[0], NamedNode | Literal)
        }
        return sorted(by_term.values(), key=lambda value: (-value.count, value.text))[:_MOST]

    return _lowered(cache, f"values {iri} {kind}", make)


def _lowered(cache: SnapshotCache, key: str, make: Callable[[], list[Value]]) -> Values:
    content = cache.values(key, make, list[Value])
    return cache.in_memory(key, lambda: Values(content, [value.text.lower() for value in content]))


def _value(term: NamedNode | Literal, count: int, label: Literal | None) -> Value:
    if isinstance(term, NamedNode):
        written = shorten(term.value)
        return Value(written, label.value if label else written, count)
    return Value(term.value if term.datatype.value in _BARE else str(term), term.value, count)


def graphs(cache: SnapshotCache) -> Values:
    """Return the named graphs."""

    def make() -> list[Value]:
        return [Value(shorten(graph.value), graph.value, 0) for graph in cache.snapshot.graphs()]

    return _lowered(cache, "graphs", make)


def of_iri(cache: SnapshotCache, iri: str) -> dict[str, int]:
    """Return the properties of an IRI, with their numbers of values."""
    if not _IRI.fullmatch(iri):
        return {}
    rows: Any = cache.snapshot.query(_PROPERTIES % iri)
    return {row[0].value: int(row[1].value) for row in rows}
