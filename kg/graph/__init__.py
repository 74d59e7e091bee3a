"""Stage 3: facts become RDF: vocabulary, IRIs, named graphs. Nothing here knows of files."""

from __future__ import annotations

from kg.graph.builds import BuildRecord, Counts, build_triples, count
from kg.graph.iris import DEFAULT_BASE, Iris, Thing
from kg.graph.packages import package_triples
from kg.graph.sources import repository_triples, source_triples

__all__ = [
    "DEFAULT_BASE",
    "BuildRecord",
    "Counts",
    "Iris",
    "Thing",
    "build_triples",
    "count",
    "package_triples",
    "repository_triples",
    "source_triples",
]
