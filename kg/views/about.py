"""What pages and faces show first about a package or a type: the view `about`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.facts import Location
from kg.graph.iris import Iris
from kg.graph.reading.queries import column, texts
from kg.views.evidence import places
from kg.views.terms import named_node

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_LITERALS: Final = {
    "version": "rnkg:version",
    "licenses": "rnkg:licenseName",
    "maintainers": "rnkg:maintainer/rdfs:label",
}
_NEEDS: Final = """SELECT DISTINCT ?label ?other {
  %s rnkg:dependsOn ?name . ?name rdfs:label ?label OPTIONAL { ?other rnkg:hasPackageName ?name }
} ORDER BY ?label ?other"""
_NEEDED: Final = """SELECT DISTINCT ?label ?other {
  %s rnkg:hasPackageName ?name . ?other rnkg:dependsOn ?name ; a rnkg:Package ; rdfs:label ?label
} ORDER BY ?label ?other"""
_FIELDS: Final = """SELECT DISTINCT ?section ?type ?name ?value ?comment ?repository ?path ?line {
  ?definition rnkg:defines %s ; rnkg:path ?path ; rnkg:hasField ?field .
  ?package rnkg:contains ?definition . ?source rnkg:contains ?package ; a rnkg:Repository ; rnkg:name ?repository .
  ?field rnkg:section ?section ; rnkg:position ?position ; rnkg:name ?name ; rnkg:fieldType ?type ; rnkg:line ?line .
  OPTIONAL { ?field rnkg:defaultValue|rnkg:constantValue ?value }
  OPTIONAL { ?field rdfs:comment ?comment }
} ORDER BY ?repository ?path xsd:integer(?line) xsd:integer(?position)"""


def about(snapshot: EmbeddedSnapshot, settings: Settings, *, iri: str) -> dict[str, Any]:
    """Return what a package needs and who needs it, and the fields that the store has of a type, by IRI.

    A package has `repository`, `version`, `licenses`, `maintainers` (lists of texts), `requires` and `required_by`:
    objects with `label` and `iri`, None for packages that are not in the store. A type has `fields`: objects with
    `section`, `type`, `name`, `value` (of a constant, or the default), `comment` and `evidence`. Anything else has an
    empty object.
    """
    node, thing = named_node(iri), Iris(settings.base).parse(iri)
    if thing and thing.kind == "package" and "#" not in iri:
        return {
            "repository": thing.parts[0],
            **{
                key: sorted(column(snapshot, f"SELECT DISTINCT ?value {{ {node} {path} ?value }}"))
                for key, path in _LITERALS.items()
            },
            "requires": _named(snapshot, _NEEDS % node),
            "required_by": _named(snapshot, _NEEDED % node),
        }
    fields = list(texts(snapshot, _FIELDS % node))
    if not fields:
        return {}
    where = places(snapshot)
    keys = ("section", "type", "name", "value", "comment")
    return {
        "fields": [
            {
                **dict(zip(keys, row, strict=False)),
                "evidence": where.evidence(repository, Location(path, int(line))),
            }
            for *row, repository, path, line in fields
        ]
    }


def _named(snapshot: EmbeddedSnapshot, query: str) -> list[dict[str, str | None]]:
    return [{"label": label, "iri": iri} for label, iri in texts(snapshot, query)]
