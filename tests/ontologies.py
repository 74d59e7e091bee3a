"""The ontologies shipped with `kg`, parsed once for all tests and read-only."""

from __future__ import annotations

from functools import cache

from rdflib import Graph

from kg.graph.ontology_files import default_ontologies

__all__ = ["named", "together"]


@cache
def named() -> dict[str, Graph]:
    """Return each ontology by its file name without the suffix."""
    return {path.stem: Graph().parse(path) for path in default_ontologies()}


@cache
def together(beginning: str = "") -> Graph:
    """Return the triples of all ontologies whose names begin with a prefix."""
    found = Graph()
    for name, graph in named().items():
        if name.startswith(beginning):
            found += graph
    return found
