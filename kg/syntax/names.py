"""Names in SPARQL: predefined prefixes, and relative IRIs (RFC 3986, 5.2)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from pyoxigraph import NamedNode, RdfFormat, parse

PREFIXES: Final = MappingProxyType(
    {
        "rnkg": "https://w3id.org/rnkg/ns#",
        "ros": "http://data.mksmart.org/onto-ros/class#",
        "rdf": "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
        "rdfs": "http://www.w3.org/2000/01/rdf-schema#",
        "owl": "http://www.w3.org/2002/07/owl#",
        "xsd": "http://www.w3.org/2001/XMLSchema#",
        "prov": "http://www.w3.org/ns/prov#",
        "dcterms": "http://purl.org/dc/terms/",
        "skos": "http://www.w3.org/2004/02/skos/core#",
        "schema": "http://schema.org/",
        "sh": "http://www.w3.org/ns/shacl#",
        "capability": "https://w3id.org/rnkg/capability#",
        "function": "https://w3id.org/rnkg/function#",
        "hardware": "https://w3id.org/rnkg/hardware#",
    }
)
"""Namespaces by prefix; a declaration in a query overrides them."""

RDF_TYPE: Final = NamedNode(PREFIXES["rdf"] + "type")
"""The property that `a` stands for."""

WELL_KNOWN: Final = MappingProxyType(
    {
        "dc": "http://purl.org/dc/elements/1.1/",
        "dcat": "http://www.w3.org/ns/dcat#",
        "foaf": "http://xmlns.com/foaf/0.1/",
        "geo": "http://www.opengis.net/ont/geosparql#",
        "qudt": "http://qudt.org/schema/qudt/",
        "sd": "http://www.w3.org/ns/sparql-service-description#",
        "sosa": "http://www.w3.org/ns/sosa/",
        "ssn": "http://www.w3.org/ns/ssn/",
        "time": "http://www.w3.org/2006/time#",
        "unit": "http://qudt.org/vocab/unit/",
        "vann": "http://purl.org/vocab/vann/",
        "void": "http://rdfs.org/ns/void#",
        "wgs84": "http://www.w3.org/2003/01/geo/wgs84_pos#",
    }
)
"""Well-known prefixes that a text must declare, with their usual namespaces."""

_LOCAL: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*")


def shorten(iri: str, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return `iri` as a prefixed name if one of the prefixes fits (see `prefixed`), else in brackets."""
    parts = prefixed(iri, prefixes)
    return ":".join(parts) if parts else f"<{iri}>"


def prefixed(iri: str, prefixes: Mapping[str, str] = PREFIXES) -> tuple[str, str] | None:
    """Return prefix and local name of an IRI, None if no prefix fits without an escape.

    The longest namespace wins; the empty prefix is used only if no other has the same one.
    """
    fitting = (
        (prefix, iri[len(namespace) :])
        for prefix, namespace in prefixes.items()
        if iri.startswith(namespace) and _LOCAL.fullmatch(iri, len(namespace))
    )
    return min(fitting, key=lambda one: (len(one[1]), one[0] == ""), default=None)


def is_absolute(iri: str) -> bool:
    """Return whether an IRI begins with a scheme."""
    return re.match(r"[A-Za-z][A-Za-z0-9+.-]*:", iri) is not None


def resolve(base: str, reference: str) -> str:
    """Return `reference` as an absolute IRI (RFC 3986, 5.2); absolute ones are unchanged.

    Raises ValueError for an invalid reference.
    """
    if is_absolute(reference):
        return reference
    try:
        # An unpaired surrogate is a ValueError when it is encoded; the parser would take the text for a file.
        (quad,) = parse(f"<{reference}> <x:> <x:> .".encode(), RdfFormat.TURTLE, base_iri=base)
    except SyntaxError as error:
        raise ValueError(error.msg) from error
    return str(quad.subject)[1:-1]
