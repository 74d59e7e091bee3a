"""The terms that ontologies define, with where they do, for editors."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import pyoxigraph
from pyoxigraph import Literal, NamedNode, RdfFormat

from kg.errors import Place
from kg.rules.documents import statements
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

_KINDS: Final = {
    PREFIXES["owl"] + "Class": "class",
    PREFIXES["rdfs"] + "Class": "class",
    PREFIXES["owl"] + "ObjectProperty": "property",
    PREFIXES["owl"] + "DatatypeProperty": "property",
    PREFIXES["owl"] + "AnnotationProperty": "property",
    PREFIXES["rdf"] + "Property": "property",
    PREFIXES["owl"] + "NamedIndividual": "individual",
    PREFIXES["skos"] + "Concept": "individual",
}
_TYPE: Final = NamedNode(PREFIXES["rdf"] + "type")
_LABEL: Final = NamedNode(PREFIXES["rdfs"] + "label")
_COMMENTS: Final = (NamedNode(PREFIXES["rdfs"] + "comment"), NamedNode(PREFIXES["skos"] + "definition"))


@dataclass(frozen=True, slots=True)
class DefinedTerm:
    """A class, property or individual: `kind` is which, `uses` how often the store has it (None: not known)."""

    iri: str
    kind: str
    label: str = ""
    comment: str = ""
    place: Place | None = None
    uses: int | None = None

    @property
    def short(self) -> str:
        """The term with its prefix, where it has a known one."""
        return shorten(self.iri)

    def described(self) -> str:
        """Return the Markdown of the hover on a term."""
        lines = [f"**{self.short}** ({self.kind})" + (f": {self.label}" if self.label else "")]
        lines += [self.comment] if self.comment else []
        lines += [f"{self.uses:,} triples in the store"] if self.uses is not None else []
        lines += [f"`{self.iri}`"]
        return "\n\n".join(lines)


@dataclass(frozen=True, slots=True)
class Terms:
    """The terms of some ontologies by their IRI."""

    by_iri: Mapping[str, DefinedTerm] = field(default_factory=dict)

    @classmethod
    def of(cls, files: Iterable[Path], uses: Mapping[str, int] | None = None) -> Terms:
        """Read the terms of files in Turtle; `uses` has how often a store uses terms, those of no ontology too."""
        found: dict[str, DefinedTerm] = {}
        counted = uses or {}
        for path in files:
            store = pyoxigraph.Store()
            store.load(path=path, format=RdfFormat.TURTLE)
            stated = statements([path])
            for quad in store.quads_for_pattern(None, _TYPE, None):
                kind = _KINDS.get(quad.object.value) if isinstance(quad.object, NamedNode) else None
                if kind and isinstance(quad.subject, NamedNode):
                    iri = quad.subject.value
                    place = Place(str(path), stated[iri].line, 1) if iri in stated else None
                    found.setdefault(iri, _term(store, quad.subject, kind, place, counted.get(iri)))
        for iri, number in counted.items():
            found.setdefault(iri, DefinedTerm(iri, "property", uses=number))
        return cls(found)

    def in_namespace(self, namespace: str) -> list[DefinedTerm]:
        """Return the terms of a namespace, sorted by name."""
        return sorted(
            (each for each in self.by_iri.values() if each.iri.startswith(namespace)), key=lambda one: one.iri
        )


def _term(store: pyoxigraph.Store, subject: NamedNode, kind: str, place: Place | None, uses: int | None) -> DefinedTerm:
    label = _text(store, subject, _LABEL)
    comment = next((text for each in _COMMENTS if (text := _text(store, subject, each))), "")
    return DefinedTerm(subject.value, kind, label, comment, place, uses)


def _text(store: pyoxigraph.Store, subject: NamedNode, predicate: NamedNode) -> str:
    texts = (quad.object for quad in store.quads_for_pattern(subject, predicate, None))
    return next((text.value for text in texts if isinstance(text, Literal)), "")
