"""Reading of findings from the store, graph by graph, which is much faster than joins over their union."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.codes import SEVERITIES
from kg.graph import vocabulary as v
from kg.graph.chains import chain_of, chain_text, likely_chain
from kg.graph.fields import Properties, one
from kg.graph.iris import Iris
from kg.graph.reading.queries import among, properties_in, texts
from kg.lint.finding import Evidence, Finding

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from kg.store.interface import Queryable


_NO_LABELS: Final[Mapping[str, str]] = MappingProxyType({})
_FINDINGS: Final = "SELECT ?s ?p ?o WHERE { GRAPH ?g { %s ?s ?p ?o } }"
_ANY: Final = "?s a rnkg:Finding ."
_OF: Final = "?s rnkg:inConfiguration %s ."
_THINGS: Final = """SELECT ?s ?p ?o WHERE {
  %s GRAPH ?g { ?s ?p ?o }
  FILTER(?p IN (rdf:type, rnkg:name, rnkg:resolvedName, rnkg:from, rnkg:to,
                rnkg:path, rnkg:line, rnkg:repository, rnkg:declaredIn, rnkg:declaredBy, rnkg:includeChain))
}"""
_LED: Final = """SELECT ?configuration ?start ?chain WHERE {
  %s
  GRAPH ?g { ?instance rnkg:startedWith ?start ; rnkg:includeChain ?chain . ?configuration rnkg:hasInstance ?instance }
}"""
"""Objects shared by systems have the includes of the instances that lead to them."""
_VERBS: Final = {
    v.bare(v.PUBLISHER): "publishes",
    v.bare(v.SUBSCRIBER): "subscribes to",
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
"""Description of a line by the class of its object."""
_REMAP: Final = v.bare(v.REMAP)


_AT: Final = v.RNKG + "at"
_EVIDENCE: Final = v.RNKG + "evidence"


def read_findings(
    graph: Queryable, base: str, configuration: str | None = None, labels: Mapping[str, str] = _NO_LABELS
) -> list[Finding]:
    """Return the sorted findings of a store; `base` is that of its IRIs.

    With `configuration`, the IRI of a launch configuration, only those about it. `labels` overrides the names of the
    configurations with these IRIs.
    """
    which = _OF % NamedNode(configuration) if configuration else _ANY
    findings = properties_in(graph, _FINDINGS % which)
    return sorted(_Reading(graph, base, findings).findings(labels), key=lambda one: one.order)


class _Reading:
    """The objects named in findings, read at once: configurations, things with lines, and their declarations."""

    def __init__(self, graph: Queryable, base: str, findings: Mapping[str, Properties]) -> None:
        self._graph = graph
        self._iris = Iris(base)
        self._findings = findings
        named = (v.RNKG + "inConfiguration", _AT, _EVIDENCE)
        self._things = self._read({iri for one in findings.values() for key in named for iri in one.get(key, ())})
        declared = {iri for one in self._things.values() for iri in one.get(v.bare(v.DECLARED_BY), ())}
        self._things |= self._read(declared - self._things.keys())
        self._led = self._chains({iri.partition("#")[0] for iri in self._things if f"{base}start/" in iri})

    def _read(self, things: Collection[str]) -> dict[str, dict[str, list[str]]]:
        return properties_in(self._graph, _THINGS % among("s", things)) if things else {}

    def _chains(self, starts: Collection[str]) -> dict[tuple[str, str], str]:
        """Return the includes that led to an instance, by its configuration and start."""
        rows = sorted(texts(self._graph, _LED % among("start", starts))) if starts else []
        return {(configuration, start): chain for configuration, start, chain in reversed(rows)}

    def findings(self, labels: Mapping[str, str]) -> Iterator[Finding]:
        """Yield the findings that have a code, a message and a named system."""
        for iri, own in self._findings.items():
            code, message = one(own, v.rnkg("code")), one(own, v.rnkg("message"))
            configuration = one(own, v.rnkg("inConfiguration"))
            system = labels.get(configuration or "") or one(self._things.get(configuration or "", {}), v.NAME)
            if code and message and system:
                yield self._finding(iri, own, code, message, (configuration or "", system))

    def _finding(self, iri: str, own: Properties, code: str, message: str, where: tuple[str, str]) -> Finding:
        """Return a finding; `where` is the configuration with its name."""
        configuration, system = where
        severity = one(own, v.rnkg("severity")) or ""
        mending = next(iter(self._places(own.get(_AT, ()), configuration)), None)
        others = dict.fromkeys(self._places(own.get(_EVIDENCE, ()), configuration))
        subjects = (*sorted(own.get(v.RNKG + "mainSubject", ())), *sorted(own.get(v.RNKG + "subject", ())))
        return Finding(
            iri=iri,
            code=code,
            rule=one(own, v.rnkg("rule")) or "",
            severity=severity if severity in SEVERITIES else "warning",
            system=system,
            source=self._source(configuration),
            message=message,
            subjects=tuple(dict.fromkeys(subjects)),
            place=mending,
            evidence=tuple(place for place in others if mending is None or str(place) != str(mending)),
            presumes_whole=one(own, v.rnkg("presumesWhole")) == "true",
            hint=one(own, v.rnkg("hint")),
            replacement=one(own, v.rnkg("replacement")),
        )

    def _places(self, things: Iterable[str], configuration: str) -> list[Evidence]:
        """Return the sorted lines of things, or of their declarations."""
        return sorted(place for thing in things for place in self._lines(thing, configuration))

    def _lines(self, thing: str, configuration: str) -> Iterator[Evidence]:
        own = self._things.get(thing, {})
        led = chain_of(self._led.get((configuration, thing.partition("#")[0])))
        words = _words(own)
        codes = (iri for iri in own.get(v.bare(v.DECLARED_BY), ()) if iri != thing)
        for written in (own, *(self._things.get(iri, {}) for iri in codes)):
            path, line, file = (one(written, term) for term in (v.PATH, v.LINE, v.DECLARED_IN))
            if path is not None:
                source = one(written, v.IN_REPOSITORY) or self._source(file or thing.partition("#")[0])
                chain = one(written, v.INCLUDE_CHAIN)
                chain = chain_text(likely_chain(path, led)) if chain is None and led else chain
                yield Evidence(path, int(line) if line else None, source, words, chain or "")
            elif peer := one(written, v.SEEN_AT):
                yield Evidence(peer, None, "", words)

    def _source(self, iri: str) -> str:
        parsed = self._iris.parse(iri)
        return parsed.parts[0] if parsed else ""


def _words(own: Properties) -> str:
    """Return a short description of the line of a thing."""
    kinds = own.get(v.bare(v.TYPE), ())
    name = one(own, v.NAME) or one(own, v.RESOLVED_NAME)
    source, target = one(own, v.FROM), one(own, v.TO)
    if _REMAP in kinds and source and target:
        return f"remaps {source} to {target}"
    verb = next((_VERBS[kind] for kind in sorted(kinds) if kind in _VERBS), None)
    return f"{verb} {name}" if verb and name else ""
