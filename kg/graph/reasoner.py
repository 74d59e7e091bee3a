"""HermiT, an OWL 2 DL reasoner, run through owlready2; only `kg.graph.ontology` imports this, when it is asked to."""

from __future__ import annotations

import io
from typing import Final

import owlready2

__all__ = ["reason"]

_IMPORTS: Final = b"<http://www.w3.org/2002/07/owl#imports>"
_ANY_NAME: Final = "http://kg.invalid/checked"


def reason(triples: bytes, java: str) -> tuple[str, ...] | None:
    """Return the IRIs of the classes that can have no instances, None when the axioms contradict each other.

    `triples` are the N-Triples of all ontologies taken together; imports are not followed, so that no network is
    used. `java` is the path of the Java program.
    """
    lines = triples.splitlines(keepends=True)
    kept = io.BytesIO(b"".join(line for line in lines if _IMPORTS not in line))
    world = owlready2.World()
    world.get_ontology(_ANY_NAME).load(fileobj=kept, only_local=True)
    owlready2.JAVA_EXE = java
    try:
        owlready2.sync_reasoner_hermit(world, debug=0)
        return tuple(sorted({cls.iri for cls in world.inconsistent_classes()} - {owlready2.Nothing.iri}))
    except owlready2.OwlReadyInconsistentOntologyError:
        return None
    finally:
        world.close()
