"""The ontologies that `kg` ships, parsed once for all tests; they are only read."""

from __future__ import annotations

from functools import cache

from rdflib import Graph

from kg.graph.ontology_files import default_ontologies

__all__ = ["named", "together"]


@cache
def named() -> dict[str, Graph]:
    """Return each ontology by the name of its file, without the ending."""
    return {path.stem: Graph().parse(path) for path in default_ontologies()}


@cache
def together(beginning: str = "") -> Graph:
    """Return the triples of all ontologies whose names begin so."""
    found = Graph()
    for name, graph in named().items():
        if name.startswith(beginning):
            found += graph
    return found
