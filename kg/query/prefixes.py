"""Prefixes that every query may use without declaring them."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["PREFIXES", "shorten"]

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
"""Prefix to namespace; a query that declares one of them itself overrides it."""


def shorten(iri: str, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return `iri` as a prefixed name if one of the prefixes fits and its rest needs no escape, else in brackets."""
    for prefix, namespace in prefixes.items():
        local = iri.removeprefix(namespace)
        if local != iri and local.replace("_", "").replace("-", "").isalnum() and local.isascii():
            return f"{prefix}:{local}"
    return f"<{iri}>"
