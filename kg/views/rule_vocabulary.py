"""Vocabulary for rules on this store: classes, properties, their combinations, rules to begin from."""

from __future__ import annotations

from collections import defaultdict
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import msgspec
import pyoxigraph
from pyoxigraph import RdfFormat

from kg.errors import RuleError
from kg.graph.ontology_files import ontologies_in_force, ontology_triples
from kg.resources import folder
from kg.rules.authoring.library import Library
from kg.rules.authoring.manual import documentation
from kg.rules.blocks.read import read
from kg.syntax.names import PREFIXES, shorten
from kg.views.complete import cache_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.query.completion.statistics import Statistics
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_HIDDEN: Final = tuple(PREFIXES[name] for name in ("owl", "sh", "rdf", "prov"))
"""Namespaces of what describes vocabularies and builds, which rules about robots are seldom about."""
_USUAL: Final = {PREFIXES["rdfs"] + "label": "is called", PREFIXES["rdfs"] + "comment": "is described as"}
"""Properties that have better words here than in their vocabulary."""
_LABELS: Final = "SELECT ?t ?l { ?t rdfs:label ?l FILTER(ISIRI(?t) && (LANG(?l) = '' || LANGMATCHES(LANG(?l), 'en'))) }"
_KINDS: Final = """
SELECT ?t ?kind { VALUES (?type ?kind) {
  (owl:Class "class") (owl:ObjectProperty "thing") (owl:DatatypeProperty "value") (owl:AnnotationProperty "value") }
  ?t a ?type FILTER(ISIRI(?t)) }"""
_SUPERS: Final = "SELECT ?t ?s { ?t rdfs:subClassOf ?s FILTER(ISIRI(?t) && ISIRI(?s)) }"
_ENDS: Final = "SELECT ?t ?c { ?t %s/(owl:unionOf/rdf:rest*/rdf:first)? ?c FILTER(ISIRI(?t) && ISIRI(?c)) }"
_COMMENTS: Final = "SELECT ?t ?c { ?t rdfs:comment ?c FILTER(ISIRI(?t)) }"


class _Ontology(msgspec.Struct, frozen=True):
    """Statements of the ontologies about terms; IRIs without brackets."""

    kinds: dict[str, str]
    labels: dict[str, str]
    comments: dict[str, str]
    supers: dict[str, list[str]]
    domains: dict[str, list[str]]
    ranges: dict[str, list[str]]


def blocks(snapshot: EmbeddedSnapshot, settings: Settings, *, fresh: str = "") -> dict[str, Any]:
    """Return the vocabulary for rules.

    `classes` have `name` (as a rule writes it), `label`, `comment`, `count` (how many things of it there are) and
    `supers`. `properties` have these but for `supers`, `from` and `to` (the classes that its subjects and objects are
    of), `literal` (whether its objects are texts and numbers), `datatype` (of these, or empty), `of` (class to how many
    of its things have it) and `leads` (classes of objects that were looked at). `ready` is false while the store is
    still being counted; with `fresh` it is counted now. `rules` are those that can be opened: `name`, `title`,
    `family`. `examples` are rules to begin from: `name`, `title`, `comment`, `rule` (`kg.rules.blocks.tree`).
    """
    cached = cache_of(snapshot, settings)
    counted = cached.statistics(fresh=True) if fresh else cached.cached_statistics()
    ontology = _ontology(ontologies_in_force(settings))
    return {
        "snapshot": snapshot.identity,
        "ready": bool(counted.properties),
        "classes": list(_classes(ontology, counted)),
        "properties": list(_properties(ontology, counted)),
        "rules": list(_rules(settings)),
        "examples": _examples(),
    }


@cache
def _ontology(files: tuple[Path, ...]) -> _Ontology:
    store = pyoxigraph.Store()
    store.bulk_load(ontology_triples(files), RdfFormat.N_TRIPLES)

    def pairs(query: str) -> Iterator[tuple[str, str]]:
        rows: Any = store.query(query, prefixes=dict(PREFIXES))
        return ((row[0].value, row[1].value) for row in rows)

    def lists(query: str) -> dict[str, list[str]]:
        values: dict[str, list[str]] = defaultdict(list)
        for term, other in pairs(query):
            values[term].append(other)
        return {term: sorted(others) for term, others in values.items()}

    return _Ontology(
        dict(sorted(pairs(_KINDS), reverse=True)),
        dict(pairs(_LABELS)),
        dict(pairs(_COMMENTS)),
        lists(_SUPERS),
        lists(_ENDS % "rdfs:domain"),
        lists(_ENDS % "rdfs:range"),
    )


def _classes(ontology: _Ontology, counted: Statistics) -> Iterator[dict[str, Any]]:
    defined = {term for term, kind in ontology.kinds.items() if kind == "class"}
    for iri in _sorted(defined | counted.classes.keys(), counted.classes):
        yield {
            **_term(iri, ontology, counted),
            "count": counted.classes.get(iri, 0),
            "supers": [shorten(one) for one in ontology.supers.get(iri, ())],
        }


def _properties(ontology: _Ontology, counted: Statistics) -> Iterator[dict[str, Any]]:
    kinds = ontology.kinds
    defined = {term for term, kind in kinds.items() if kind != "class"} | _USUAL.keys()
    users: dict[str, dict[str, int]] = defaultdict(dict)
    for kind, properties in counted.used.items():
        for iri, number in properties.items():
            if not kind.startswith(_HIDDEN):
                users[iri][shorten(kind)] = number
    for iri in _sorted(defined | counted.properties.keys(), counted.properties):
        ends = ontology.ranges.get(iri, [])
        literal = kinds.get(iri) == "value" or iri in _USUAL or (iri not in kinds and iri in counted.literal)
        yield {
            **_term(iri, ontology, counted),
            "count": counted.properties.get(iri, 0),
            "from": [shorten(one) for one in ontology.domains.get(iri, ())],
            "to": [] if literal else [shorten(one) for one in ends],
            "literal": literal,
            "datatype": shorten(ends[0]) if literal and ends else "",
            "of": users.get(iri, {}),
            "leads": {shorten(one): number for one, number in counted.leads.get(iri, {}).items()},
        }


def _sorted(terms: set[str], counts: dict[str, int]) -> list[str]:
    """Return terms that rules may be about, the most used first."""
    shown = (iri for iri in terms if not iri.startswith(_HIDDEN))
    return sorted(shown, key=lambda iri: (-counts.get(iri, 0), iri))


def _term(iri: str, ontology: _Ontology, counted: Statistics) -> dict[str, Any]:
    name = shorten(iri)
    plain = name.rpartition(":")[2].rstrip(">").rpartition("/")[2]
    return {
        "name": name,
        "label": _USUAL.get(iri) or ontology.labels.get(iri) or plain,
        "comment": ontology.comments.get(iri) or counted.comments.get(iri, ""),
    }


def _rules(settings: Settings) -> Iterator[dict[str, str]]:
    """Yield the rules whose notation blocks can show."""
    for entry in Library.of(settings).entries.values():
        if entry.path.suffix == ".rq":
            try:
                title = documentation(entry).title
            except RuleError:
                continue
            yield {"name": entry.name, "title": title, "family": entry.family}


@cache
def _examples() -> list[dict[str, Any]]:
    """Return the rules to begin from that come with kg, by name."""
    examples = []
    for path in sorted((folder("examples") / "rules").glob("*/*.rq")):
        rule = read(path.read_text("utf-8"), f"{path.parent.name}/{path.stem}", str(path))
        examples.append({"name": rule.name, "title": rule.title, "comment": rule.why, "rule": rule})
    return examples
