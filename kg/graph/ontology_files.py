"""The ontologies in force: those that `kg` brings along and those of the user, as N-Triples."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final

from pyoxigraph import BlankNode, RdfFormat, Triple, serialize

from kg.errors import GraphError, Place, SourceError
from kg.resources import folder
from kg.settings import Settings, user_paths
from kg.store.files import format_of, quads_of

ONTOLOGIES: Final = (
    "onto-ros.ttl",
    "rnkg.ttl",
    "capability.ttl",
    "capability-contexts.ttl",
    "capability-exclusions.ttl",
    "capability-parameters.ttl",
    "function.ttl",
    "hardware.ttl",
    "hardware-products.ttl",
    "architecture.ttl",
    "ontobot-alignment.ttl",
)
"""The ontologies that `kg` brings along, in its folder `ontology`."""
SHAPES: Final = "shapes.ttl"
"""The SHACL shapes that `kg` brings along, in the same folder."""


_ENDINGS: Final = frozenset({".ttl", ".nt", ".rdf", ".owl", ".jsonld"})
_TYPE: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type"
_SETTING: Final = "https://w3id.org/rnkg/ns#SettingProperty"


def default_ontologies() -> tuple[Path, ...]:
    """Return the paths of the ontologies that `kg` brings along."""
    return tuple(folder("ontology") / name for name in ONTOLOGIES)


def ontologies_in_force(settings: Settings) -> tuple[Path, ...]:
    """Return the paths of the ontologies that `kg` brings along, then those of the setting `ontology`, by name.

    Raises UsageError KG002 for a folder or file that the setting names and that does not exist.
    """
    shipped = folder("ontology").resolve()
    own: list[Path] = []
    for path in user_paths(settings, "ontology"):
        if path.is_file():
            own.append(path)
        elif path.resolve() != shipped:
            own += sorted(one for one in path.iterdir() if one.suffix in _ENDINGS and one.is_file())
    return (*default_ontologies(), *own)


def shapes_file() -> Path:
    """Return the path of the SHACL shapes that `kg` brings along."""
    return folder("ontology") / SHAPES


def ontology_triples(paths: Iterable[Path] | None = None) -> bytes:
    """Return the N-Triples of the graph `ontology`, the same bytes for the same files.

    `paths` are files in a format that their ending names (.ttl, .nt, .rdf, .owl, .jsonld); without them it is what
    `kg` brings along. A `rnkg:SettingProperty` has one value: that of the last file that gives one, so that users
    can replace a weight or a threshold. Raise `GraphError` KG601 for a file that is not RDF.
    """
    listed = default_ontologies() if paths is None else tuple(paths)
    files = [list(_named(_parsed(path), f"f{number}b")) for number, path in enumerate(listed)]
    settings = {
        triple.subject
        for file in files
        for triple in file
        if triple.predicate.value == _TYPE and getattr(triple.object, "value", "") == _SETTING
    }
    last = {
        (triple.subject, triple.predicate): number
        for number, file in enumerate(files)
        for triple in file
        if triple.predicate in settings
    }
    triples = [
        triple
        for number, file in enumerate(files)
        for triple in file
        if last.get((triple.subject, triple.predicate), number) == number
    ]
    return serialize(triples, format=RdfFormat.N_TRIPLES) or b""


def _parsed(path: Path) -> list[Any]:
    kind = format_of(path)
    if kind is None:
        message = f"{path.name} has an ending that names no RDF format"
        raise GraphError("KG601", message, place=Place(str(path)), hint="use .ttl, .nt, .rdf, .owl or .jsonld")
    try:
        return list(quads_of(path.resolve(), kind))
    except SourceError as error:
        raise GraphError("KG601", error.message, place=error.place) from error


def _named(quads: Iterable[Any], prefix: str) -> Iterator[Triple]:
    """Yield the triples with their blank nodes named by `prefix` and a number, in the order they appear."""
    names: dict[BlankNode, BlankNode] = {}

    def renamed(term: Any) -> Any:
        if not isinstance(term, BlankNode):
            return term
        return names.setdefault(term, BlankNode(f"{prefix}{len(names)}"))

    for quad in quads:
        yield Triple(renamed(quad.subject), quad.predicate, renamed(quad.object))
