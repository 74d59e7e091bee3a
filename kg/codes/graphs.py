"""The codes of graph and ontology: KG6xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG601": CodeEntry(
        "RDF does not parse",
        "An RDF file is not valid in the format that kg read it as.",
        "Correct the file at the line given, or name its format.",
    ),
    "KG602": CodeEntry(
        "ontology inconsistent",
        "The reasoner found a contradiction or an unsatisfiable class in the ontologies.",
        "Read the explanation and correct the ontology.",
    ),
    "KG603": CodeEntry(
        "reasoner missing",
        "The OWL DL reasoner needs Java, which was not found.",
        "Install a Java runtime (Debian: default-jre-headless).",
    ),
    "KG604": CodeEntry(
        "shape violated",
        "Data in the store violates a SHACL shape.",
        "Correct the data. The report names the node, the shape and the value.",
    ),
    "KG605": CodeEntry(
        "optional part missing",
        "The command needs Python packages that are an optional part of `kg`.",
        "Install them with `pip install 'kg-ros[ontology]'`.",
    ),
}
