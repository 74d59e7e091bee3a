"""Candidates from the store: classes, properties, values, graphs, and prefixes of names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.query.completion import names
from kg.query.completion.meaning import asserted, behind, classes, fitting, leading
from kg.query.completion.outline import TYPE, Slot, Step
from kg.query.completion.site import Candidate, Site
from kg.query.completion.typed import Form
from kg.syntax.lexer import Kind
from kg.syntax.names import WELL_KNOWN

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


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
        fitting_ones = {iri: (number, "") for iri, number in names.of_iri(site.cache, frame.subject).items()}
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
    offered = names.values(site.cache, iri, kinds[0] if kinds else None, literal=literal)
    for value in offered.holding(site.typed.text.removeprefix("<")):
        label = value.text if literal or value.written.startswith("<") else value.written
        prefix = "" if literal else _prefix(value.written)
        detail = value.written if label != value.written and not literal else ""
        yield Candidate(label, value.written, "value", value.text, detail, value.count, prefix=prefix)


def graph_names(site: Site) -> Iterator[Candidate]:
    """Yield the named graphs."""
    for one in names.graphs(site.cache).holding(site.typed.text.removeprefix("<")):
        yield Candidate(one.written, one.written, "graph", one.text, prefix=_prefix(one.written))
