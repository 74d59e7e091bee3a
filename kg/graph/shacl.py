"""SHACL validation by pyshacl; only `kg.graph.ontology` imports this, when it is asked to."""

from __future__ import annotations

from typing import Any, Final

import pyshacl
from rdflib import RDF, BNode, Graph, URIRef

from kg.errors import GraphError
from kg.graph.ontology import ShapeFinding

_SHACL: Final = "http://www.w3.org/ns/shacl#"


def findings(triples: bytes, shapes: bytes) -> tuple[ShapeFinding, ...]:
    """Return where the data `triples` does not conform to `shapes`, both N-Triples, sorted by place and message.

    Raise `GraphError` KG601 when either does not parse or the shapes are not valid SHACL.
    """
    _conforms, report, _text = pyshacl.validate(_graph(triples), shacl_graph=_graph(shapes), inference="none")
    if not isinstance(report, Graph):
        raise GraphError("KG601", str(report))
    results = report.subjects(RDF.type, URIRef(f"{_SHACL}ValidationResult"))
    results_read = (_finding(report, each) for each in results)
    return tuple(sorted(results_read, key=lambda each: (each.focus, each.message, each.value or "")))


def _graph(triples: bytes) -> Graph:
    try:
        return Graph().parse(data=triples, format="nt")
    except Exception as error:
        raise GraphError("KG601", str(error)) from error


def _finding(report: Graph, result: Any) -> ShapeFinding:
    def value(name: str) -> Any:
        return report.value(result, URIRef(_SHACL + name))

    def spelled(name: str) -> str | None:
        term = value(name)
        return None if term is None or isinstance(term, BNode) else str(term.n3())

    return ShapeFinding(
        severity=str(value("resultSeverity")).removeprefix(_SHACL).lower(),
        message=str(value("resultMessage") or value("sourceConstraintComponent")),
        focus=spelled("focusNode") or "",
        path=spelled("resultPath"),
        value=spelled("value"),
        shape=spelled("sourceShape"),
    )
