"""Findings as rules left them in the store: a query for each kind of row, so that each is answered in one pass."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from kg.codes.severities import SEVERITIES
from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.lint.finding import Evidence, Finding

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.graph.reading import Queryable

__all__ = ["read_findings"]

_PREFIXES: Final = {"ros": v.ROS, "rnkg": v.RNKG, "rdf": v.RDF}
_FINDINGS: Final = """
SELECT ?finding ?code ?rule ?severity ?system ?message ?whole ?hint WHERE {
  ?finding a rnkg:Finding ; rnkg:code ?code ; rnkg:message ?message ; rnkg:inConfiguration/rnkg:name ?system .
  OPTIONAL { ?finding rnkg:rule ?rule }
  OPTIONAL { ?finding rnkg:severity ?severity }
  OPTIONAL { ?finding rnkg:presumesWhole ?whole }
  OPTIONAL { ?finding rnkg:hint ?hint }
}"""
_SUBJECTS: Final = """
SELECT ?finding ?relation ?subject WHERE {
  VALUES ?relation { rnkg:mainSubject rnkg:subject }
  ?finding a rnkg:Finding ; ?relation ?subject .
}"""
_PLACES: Final = """
SELECT DISTINCT ?finding ?relation ?thing ?path ?line ?file ?chain WHERE {
  VALUES ?relation { rnkg:at rnkg:evidence }
  ?finding a rnkg:Finding ; ?relation ?thing .
  ?thing rnkg:declaredBy? ?written .
  ?written rnkg:path ?path .
  OPTIONAL { ?written rnkg:line ?line }
  OPTIONAL { ?written rnkg:declaredIn ?file }
  OPTIONAL { ?written rnkg:includeChain ?chain }
}"""
_THINGS: Final = """
SELECT DISTINCT ?thing ?kind ?name ?from ?to WHERE {
  { SELECT DISTINCT ?thing WHERE { ?finding a rnkg:Finding ; rnkg:at|rnkg:evidence ?thing } }
  ?thing a ?kind .
  OPTIONAL { ?thing rnkg:resolvedName ?resolved }
  OPTIONAL { ?thing rnkg:name ?given }
  BIND(COALESCE(?given, ?resolved) AS ?name)
  OPTIONAL { ?thing rnkg:from ?from ; rnkg:to ?to }
}"""
_VERBS: Final = {
    v.bare(v.PUBLISHER): "publishes",
    v.bare(v.SUBSCRIBER): "subscribes",
    v.bare(v.SERVICE_SERVER): "offers the service",
    v.bare(v.SERVICE_CLIENT): "calls the service",
    v.bare(v.ACTION_SERVER): "offers the action",
    v.bare(v.ACTION_CLIENT): "calls the action",
    v.bare(v.PARAMETER): "has the parameter",
    v.bare(v.SETTING): "sets",
    v.bare(v.INSTANCE): "starts",
    v.bare(v.ARGUMENT): "declares the argument",
    v.bare(v.CONFIGURATION): "is",
    v.bare(v.NODE_TYPE): "is the code of",
}
"""What happens in the line of a thing, by its class."""
_REMAP: Final = v.bare(v.REMAP)


@dataclass(frozen=True, slots=True)
class _Found:
    """Rows of the queries by finding."""

    subjects: Mapping[str, list[tuple[bool, str]]]
    places: Mapping[str, list[tuple[bool, Evidence]]]


def read_findings(graph: Queryable, base: str) -> list[Finding]:
    """Return the findings of a store, sorted; `base` is that of its IRIs."""
    found = _Found(_subjects(graph), _places(graph, base))
    rows: Iterable[Any] = graph.query(_FINDINGS, prefixes=_PREFIXES)
    return sorted((_finding(row, found) for row in rows), key=lambda one: one.order)


def _finding(row: Any, found: _Found) -> Finding:
    iri = row["finding"].value
    subjects = sorted(found.subjects.get(iri, ()), key=lambda one: (not one[0], one[1]))
    places = sorted(found.places.get(iri, ()), key=lambda one: one[1])
    severity = row["severity"].value if row["severity"] else ""
    mending = next((place for at, place in places if at), None)
    others = dict.fromkeys(place for at, place in places if not at)
    return Finding(
        iri=iri,
        code=row["code"].value,
        rule=row["rule"].value if row["rule"] else "",
        severity=severity if severity in SEVERITIES else "warning",
        system=row["system"].value,
        message=row["message"].value,
        subjects=tuple(dict.fromkeys(subject for _, subject in subjects)),
        place=mending,
        evidence=tuple(place for place in others if mending is None or str(place) != str(mending)),
        presumes_whole=bool(row["whole"]) and row["whole"].value == "true",
        hint=row["hint"].value if row["hint"] else None,
    )


def _subjects(graph: Queryable) -> dict[str, list[tuple[bool, str]]]:
    found: defaultdict[str, list[tuple[bool, str]]] = defaultdict(list)
    rows: Iterable[Any] = graph.query(_SUBJECTS, prefixes=_PREFIXES)
    for row in rows:
        found[row["finding"].value].append((row["relation"].value.endswith("mainSubject"), row["subject"].value))
    return found


def _places(graph: Queryable, base: str) -> dict[str, list[tuple[bool, Evidence]]]:
    iris, words = Iris(base), dict(_words(graph))
    found: defaultdict[str, list[tuple[bool, Evidence]]] = defaultdict(list)
    rows: Iterable[Any] = graph.query(_PLACES, prefixes=_PREFIXES)
    for row in rows:
        file = iris.parse(row["file"].value) if row["file"] else None
        place = Evidence(
            path=row["path"].value,
            line=int(row["line"].value) if row["line"] else None,
            repository=file.parts[0] if file else "",
            words=words.get(row["thing"].value, ""),
            chain=row["chain"].value if row["chain"] else "",
        )
        found[row["finding"].value].append((row["relation"].value.endswith("#at"), place))
    return found


def _words(graph: Queryable) -> Iterator[tuple[str, str]]:
    """Yield what happens in the line of each thing that a finding names, in a few words."""
    rows: Iterable[Any] = graph.query(_THINGS, prefixes=_PREFIXES)
    for row in rows:
        kind, name = row["kind"].value, row["name"]
        if kind == _REMAP and row["from"] and row["to"]:
            yield row["thing"].value, f"remaps {row['from'].value} to {row['to'].value}"
        elif kind in _VERBS and name:
            yield row["thing"].value, f"{_VERBS[kind]} {name.value}"
