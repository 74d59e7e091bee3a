"""HermiT, a reasoner for OWL 2 DL, as owlready2 brings it along: a Java program that reads N-Triples."""

from __future__ import annotations

import subprocess
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from kg.errors import GraphError

__all__ = ["hermit", "reason"]

_IMPORTS: Final = b"<http://www.w3.org/2002/07/owl#imports>"
_NOTHING: Final = "http://www.w3.org/2002/07/owl#Nothing"
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
    lines = triples.splitlines(keepends=True)
    with TemporaryDirectory(prefix="kg-") as folder:
        checked = Path(folder) / "checked.nt"
        checked.write_bytes(b"".join(line for line in lines if _IMPORTS not in line))
        command = [java, _MEMORY, "-cp", str(archive), _PROGRAM, "--no-prefixes", "--unsatisfiable", checked.as_uri()]
        outcome = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - no shell, our file
    impossible = {line.strip() for line in outcome.stdout.splitlines() if line.startswith("\t")}
    if outcome.returncode == 0 and _NOTHING in impossible:
        return tuple(sorted(impossible - {_NOTHING}))
    if _INCONSISTENT in outcome.stderr:
        return None
    raise GraphError("KG602", f"the reasoner cannot work with it: {_gist(outcome.stderr)}")


def _gist(report: str) -> str:
    """Return the line of a Java stack trace that says what happened."""
    lines = [line.strip() for line in report.splitlines() if line.strip()]
    telling = next((line for line in lines if "Exception" in line or "Error" in line), lines[0] if lines else "")
    return telling.rpartition("Exception: ")[2]
