"""Checks of ontologies by a reasoner for OWL 2 DL, and of data by SHACL shapes.

Both need the optional part `ontology` of `kg`. The reasoner is HermiT, a Java program that owlready2 brings along;
shapes are the work of pyshacl.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import time
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import pyshacl
from pyoxigraph import NamedNode, RdfFormat, Triple, parse
from rdflib import RDF, BNode, Graph, URIRef

from kg.errors import GraphError
from kg.graph import vocabulary as v
from kg.graph.ontology_files import default_ontologies, ontology_triples, shapes_file

_IMPORTS: Final = b"<http://www.w3.org/2002/07/owl#imports>"
_NOTHING: Final = v.OWL + "Nothing"
_TRIVIAL: Final = frozenset(v.OWL + name for name in ("Thing", "Nothing"))
_AXIOM: Final = re.compile(r"(\w+)\( (<[^>]+>(?: <[^>]+>)+) \)")
_PROPERTIES: Final = {
    "SubClassOf": NamedNode(v.RDFS + "subClassOf"),
    "EquivalentClasses": NamedNode(v.OWL + "equivalentClass"),
    "SubObjectPropertyOf": NamedNode(v.RDFS + "subPropertyOf"),
    "SubDataPropertyOf": NamedNode(v.RDFS + "subPropertyOf"),
    "EquivalentObjectProperties": NamedNode(v.OWL + "equivalentProperty"),
    "EquivalentDataProperties": NamedNode(v.OWL + "equivalentProperty"),
    "Type": NamedNode(v.bare(v.TYPE)),
}
"""What each kind of axiom that the reasoner prints is in RDF (OWL 2 Mapping to RDF Graphs, section 2.1)."""
_PROGRAM: Final = "org.semanticweb.HermiT.cli.CommandLine"
_INCONSISTENT: Final = "InconsistentOntologyException"
_MEMORY: Final = "-Xmx2000M"


@dataclass(frozen=True, slots=True)
class OntologyCheck:
    """The reasoner's result for one ontology, or for several together.

    `files` are the paths taken together. An inconsistent ontology contradicts itself as a whole; otherwise
    `unsatisfiable` holds the IRIs of the classes that can have no instances. `seconds` is the time it took.
    """

    files: tuple[Path, ...]
    consistent: bool
    unsatisfiable: tuple[str, ...]
    seconds: float

    @property
    def good(self) -> bool:
        """Whether there is nothing to mend."""
        return self.consistent and not self.unsatisfiable

    def error(self) -> GraphError | None:
        """The failed check as an error KG602, None if it passed."""
        names = ", ".join(path.name for path in self.files)
        if not self.consistent:
            hint = "look for an individual of two disjoint classes, or a property used outside its domain and range"
            if len(self.files) > 1:
                hint = "each may be consistent alone: look where they use the same class or individual"
            return GraphError("KG602", f"{names}: the axioms contradict each other", hint=hint)
        if self.unsatisfiable:
            return GraphError("KG602", f"{names}: no instance is possible of {', '.join(self.unsatisfiable)}")
        return None


@dataclass(frozen=True, slots=True)
class ShapeFinding:
    """A place in the data that does not conform to a shape; terms are written as N-Triples writes them.

    `severity` is violation, warning or info; `shape` is the IRI of the shape, None when it has none of its own.
    """

    severity: str
    message: str
    focus: str
    path: str | None
    value: str | None
    shape: str | None

    def error(self) -> GraphError:
        """Return the finding as an error KG604."""
        at = " ".join(part for part in (self.path, self.value) if part)
        return GraphError("KG604", f"{self.focus}{f', {at}' if at else ''}: {self.message}")


def check(paths: Iterable[Path] | None = None) -> Iterator[OntologyCheck]:
    """Yield the verdict of HermiT on each ontology alone, and last on all of them together.

    Without `paths` it is about the ontologies that `kg` brings along; with them about the files given, each alone and
    together with those that `kg` brings along, which they may build on. Raise `GraphError`: KG601 for a file that
    does not parse, KG603 without Java, KG605 without owlready2.
    """
    java, archive = _reasoner()
    ours = default_ontologies()
    alone = ours if paths is None else tuple(paths)
    together = ours + tuple(path for path in alone if path not in ours)
    return (_check(files, java, archive) for files in [*((path,) for path in alone), together])


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
    entailed = _entailed((*ours, *further), java, archive)
    if further:
        entailed -= _entailed(ours, java, archive)
    return tuple(sorted(entailed, key=str))


def _entailed(files: tuple[Path, ...], java: str, archive: Path) -> frozenset[Triple]:
    entailed = _entailments(ontology_triples(files), java, archive)
    if entailed is None:
        hint = "`kg ontology check FILE` finds the file."
        raise GraphError("KG602", "the axioms contradict each other, so everything follows from them", hint=hint)
    return entailed


def _reasoner() -> tuple[str, Path]:
    """Return the paths of Java and of HermiT."""
    package = find_spec("owlready2")
    if package is None or package.origin is None:
        raise _missing("owlready2")
    archive = Path(package.origin).parent / "hermit" / "HermiT.jar"
    home = os.environ.get("JAVA_HOME")
    java = (shutil.which("java", path=str(Path(home) / "bin")) if home else None) or shutil.which("java")
    if java is None:
        raise GraphError("KG603", "no `java` on the PATH or in JAVA_HOME")
    return java, archive


def _check(files: tuple[Path, ...], java: str, archive: Path) -> OntologyCheck:
    started = time.perf_counter()
    unsatisfiable = _unsatisfiable(ontology_triples(files), java, archive)
    return OntologyCheck(files, unsatisfiable is not None, unsatisfiable or (), time.perf_counter() - started)


def validate(triples: bytes, shapes: Path | None = None) -> tuple[ShapeFinding, ...]:
    """Return where data (N-Triples) does not conform to SHACL shapes, by default those of `kg`.

    Raise `GraphError`: KG601 for shapes or data that do not parse, KG605 without pyshacl.
    """
    if find_spec("pyshacl") is None:
        raise _missing("pyshacl")

    return findings(triples, ontology_triples([shapes or shapes_file()]))


def _missing(module: str) -> GraphError:
    return GraphError("KG605", f"{module} is not installed", hint="pip install 'kg-ros[ontology]'")


def _unsatisfiable(triples: bytes, java: str, archive: Path) -> tuple[str, ...] | None:
    """Return the IRIs of the classes that can have no instances, None when the axioms contradict each other.

    `triples` are the N-Triples of all ontologies taken together; imports are not followed, so that no network is
    used. `java` is the path of the Java program, `archive` that of HermiT. Raise `GraphError` KG602 for what the
    reasoner cannot work with (a malformed value, a data type outside the OWL 2 datatype map).
    """
    outcome = _run(triples, java, archive, "--no-prefixes", "--unsatisfiable")
    impossible = {line.strip() for line in outcome.stdout.splitlines() if line.startswith("\t")}
    if outcome.returncode == 0 and _NOTHING in impossible:
        return tuple(sorted(impossible - {_NOTHING}))
    if _INCONSISTENT in outcome.stderr:
        return None
    raise GraphError("KG602", f"the reasoner cannot work with it: {_gist(outcome.stderr)}")


def _entailments(triples: bytes, java: str, archive: Path) -> frozenset[Triple] | None:
    """Return what follows about classes, properties and individuals beyond `triples`; None for a contradiction.

    These are the direct super-classes and super-properties, equivalent ones, and the direct classes of individuals.
    Trivial axioms, such as subclasses of owl:Thing, are left out. The parameters and errors are
    those of `_unsatisfiable`.
    """
    outcome = _run(triples, java, archive, "-c", "-O", "-D", "-I")
    if _INCONSISTENT in outcome.stderr:
        return None
    if outcome.returncode or "Exception" in outcome.stderr:
        raise GraphError("KG602", f"the reasoner cannot work with it: {_gist(outcome.stderr)}")
    stated = {quad.triple for quad in parse(triples, RdfFormat.N_TRIPLES)}
    return frozenset(_triples(outcome.stdout, stated))


def _triples(printed: str, stated: Collection[Triple]) -> Iterator[Triple]:
    """Yield the axioms that the reasoner printed, without those known; equivalent terms are linked to the first."""
    for kind, terms in _AXIOM.findall(printed):
        first, *others = (term.strip("<>") for term in terms.split())
        for other in others:
            if kind not in _PROPERTIES or _TRIVIAL & {first, other}:
                continue
            subject, relation, value = NamedNode(first), _PROPERTIES[kind], NamedNode(other)
            # An equivalence that a file has the other way round is known as well.
            turned = kind.startswith("Equivalent") and Triple(value, relation, subject) in stated
            if not turned and (axiom := Triple(subject, relation, value)) not in stated:
                yield axiom


def _run(triples: bytes, java: str, archive: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Return what HermiT prints about triples with options; imports are left out."""
    lines = triples.splitlines(keepends=True)
    # owlready2 adds classes to HermiT, in folders next to the archive: these implement `-I`.
    path = os.pathsep.join([str(archive.parent), str(archive)])
    with TemporaryDirectory(prefix="kg-") as folder:
        checked = Path(folder) / "checked.nt"
        checked.write_bytes(b"".join(line for line in lines if _IMPORTS not in line))
        command = [java, _MEMORY, "-cp", path, _PROGRAM, *options, checked.as_uri()]
        return subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - no shell, our file


def _gist(report: str) -> str:
    """Return the line of a Java stack trace that says what happened."""
    lines = [line.strip() for line in report.splitlines() if line.strip()]
    telling = next((line for line in lines if "Exception" in line or "Error" in line), lines[0] if lines else "")
    return telling.rpartition("Exception: ")[2]


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
