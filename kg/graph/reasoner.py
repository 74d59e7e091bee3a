"""HermiT, a reasoner for OWL 2 DL, as owlready2 brings it along: a Java program that reads N-Triples."""

from __future__ import annotations

import os
import re
import subprocess
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, RdfFormat, Triple, parse

from kg.errors import GraphError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

_IMPORTS: Final = b"<http://www.w3.org/2002/07/owl#imports>"
_OWL: Final = "http://www.w3.org/2002/07/owl#"
_RDFS: Final = "http://www.w3.org/2000/01/rdf-schema#"
_NOTHING: Final = _OWL + "Nothing"
_TRIVIAL: Final = frozenset(_OWL + name for name in ("Thing", "Nothing"))
_AXIOM: Final = re.compile(r"(\w+)\( (<[^>]+>(?: <[^>]+>)+) \)")
_PROPERTIES: Final = {
    "SubClassOf": NamedNode(_RDFS + "subClassOf"),
    "EquivalentClasses": NamedNode(_OWL + "equivalentClass"),
    "SubObjectPropertyOf": NamedNode(_RDFS + "subPropertyOf"),
    "SubDataPropertyOf": NamedNode(_RDFS + "subPropertyOf"),
    "EquivalentObjectProperties": NamedNode(_OWL + "equivalentProperty"),
    "EquivalentDataProperties": NamedNode(_OWL + "equivalentProperty"),
    "Type": NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type"),
}
"""What each kind of axiom that the reasoner prints is in RDF (OWL 2 Mapping to RDF Graphs, section 2.1)."""
_PROGRAM: Final = "org.semanticweb.HermiT.cli.CommandLine"
_INCONSISTENT: Final = "InconsistentOntologyException"
_MEMORY: Final = "-Xmx2000M"


def hermit() -> Path | None:
    """Return the path of HermiT's archive, None when owlready2 is not installed."""
    package = find_spec("owlready2")
    if package is None or package.origin is None:
        return None
    return Path(package.origin).parent / "hermit" / "HermiT.jar"


def reason(triples: bytes, java: str, archive: Path) -> tuple[str, ...] | None:
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


def entailments(triples: bytes, java: str, archive: Path) -> frozenset[Triple] | None:
    """Return what follows about classes, properties and individuals beyond `triples`; None for a contradiction.

    These are the direct super-classes and super-properties, equivalent ones, and the direct classes of individuals.
    What a reader knows anyway, such as subclasses of owl:Thing, is left out. The parameters and errors are
    those of `reason`.
    """
    outcome = _run(triples, java, archive, "-c", "-O", "-D", "-I")
    if _INCONSISTENT in outcome.stderr:
        return None
    if outcome.returncode or "Exception" in outcome.stderr:
        raise GraphError("KG602", f"the reasoner cannot work with it: {_gist(outcome.stderr)}")
    known = {quad.triple for quad in parse(triples, RdfFormat.N_TRIPLES)}
    return frozenset(_triples(outcome.stdout, known))


def _triples(printed: str, known: Collection[Triple]) -> Iterator[Triple]:
    """Yield the axioms that the reasoner printed, without those known; equivalent terms are linked to the first."""
    for kind, terms in _AXIOM.findall(printed):
        first, *others = (term.strip("<>") for term in terms.split())
        for other in others:
            if kind not in _PROPERTIES or _TRIVIAL & {first, other}:
                continue
            subject, relation, value = NamedNode(first), _PROPERTIES[kind], NamedNode(other)
            # An equivalence that a file has the other way round is known as well.
            turned = kind.startswith("Equivalent") and Triple(value, relation, subject) in known
            if not turned and (axiom := Triple(subject, relation, value)) not in known:
                yield axiom


def _run(triples: bytes, java: str, archive: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Return what HermiT prints about triples with options; imports are left out."""
    lines = triples.splitlines(keepends=True)
    # owlready2 adds classes to HermiT, which it keeps in folders beside the archive: they know `-I`.
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
