"""Checks of ontologies by an OWL 2 DL reasoner (HermiT) and of data by SHACL shapes.

Both need the optional part `ontology` of `kg` (owlready2, pyshacl), the reasoner a Java runtime too.
"""

from __future__ import annotations

import os
import shutil
import time
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from kg.errors import GraphError
from kg.graph.findings import OntologyCheck, ShapeFinding
from kg.graph.ontology_files import default_ontologies, ontology_triples, shapes_file
from kg.graph.reasoner import entailments, hermit, reason

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pyoxigraph import Triple

__all__ = ["OntologyCheck", "ShapeFinding", "check", "classify", "default_ontologies", "ontology_triples", "validate"]


def check(paths: Iterable[Path] | None = None) -> tuple[OntologyCheck, ...]:
    """Return the verdict of HermiT on each ontology alone, and last on all of them together.

    Without `paths` it is about the ontologies that `kg` brings along; with them about the files given, each alone and
    together with those that `kg` brings along, which they may build on. Raise `GraphError`: KG601 for a file that
    does not parse, KG603 without Java, KG605 without owlready2.
    """
    java, archive = _reasoner()
    ours = default_ontologies()
    alone = ours if paths is None else tuple(paths)
    together = ours + tuple(path for path in alone if path not in ours)
    return tuple(_check(files, java, archive) for files in [*((path,) for path in alone), together])


def classify(paths: Iterable[Path] | None = None) -> tuple[Triple, ...]:
    """Return what follows from ontologies: classes and properties in order, and the classes of individuals.

    Without `paths` it is about the ontologies that `kg` brings along; with them about the files given together with
    those, without what follows from those alone. The triples are sorted.

    Raise `GraphError`: KG601 for a file that does not parse, KG602 for a contradiction, KG603 without Java, KG605
    without owlready2.
    """
    java, archive = _reasoner()
    ours = default_ontologies()
    further = [path for path in paths or () if path not in ours]
    found = _entailed((*ours, *further), java, archive)
    if further:
        found -= _entailed(ours, java, archive)
    return tuple(sorted(found, key=str))


def _entailed(files: tuple[Path, ...], java: str, archive: Path) -> frozenset[Triple]:
    found = entailments(ontology_triples(files), java, archive)
    if found is None:
        raise GraphError(
            "KG602",
            "the axioms contradict each other, so everything follows from them",
            hint="`kg ontology check FILE` finds the file.",
        )
    return found


def _reasoner() -> tuple[str, Path]:
    """Return the paths of Java and of HermiT."""
    archive = hermit()
    if archive is None:
        raise _missing("owlready2")
    return _java(), archive


def _check(files: tuple[Path, ...], java: str, archive: Path) -> OntologyCheck:
    started = time.perf_counter()
    unsatisfiable = reason(ontology_triples(files), java, archive)
    return OntologyCheck(files, unsatisfiable is not None, unsatisfiable or (), time.perf_counter() - started)


def validate(triples: bytes, shapes: Path | None = None) -> tuple[ShapeFinding, ...]:
    """Return where data (N-Triples) does not conform to SHACL shapes, those of `kg` unless told.

    Raise `GraphError`: KG601 for shapes or data that do not parse, KG605 without pyshacl.
    """
    if find_spec("pyshacl") is None:
        raise _missing("pyshacl")
    from kg.graph.shacl import findings  # noqa: PLC0415 - needs the optional part

    return findings(triples, ontology_triples([shapes or shapes_file()]))


def _java() -> str:
    home = os.environ.get("JAVA_HOME")
    found = (shutil.which("java", path=str(Path(home) / "bin")) if home else None) or shutil.which("java")
    if found is None:
        raise GraphError("KG603", "no `java` on the PATH or in JAVA_HOME")
    return found


def _missing(module: str) -> GraphError:
    return GraphError("KG605", f"{module} is not installed", hint="pip install 'kg-ros[ontology]'")
