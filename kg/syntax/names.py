"""Names in SPARQL: prefixes that every query may use without declaring them, and relative IRIs (RFC 3986, 5.2)."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["PREFIXES", "WELL_KNOWN", "is_absolute", "prefixed", "resolve", "shorten"]

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
"""Prefixes that a text must declare, with the namespace that they usually stand for."""

_LOCAL: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*")
_PARTS: Final = re.compile(r"(?:([^:/?#]+):)?(?://([^/?#]*))?([^?#]*)(?:\?([^#]*))?(?:#(.*))?", re.DOTALL)


def shorten(iri: str, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return `iri` as a prefixed name if one of the prefixes fits (see `prefixed`), else in brackets."""
    found = prefixed(iri, prefixes)
    return ":".join(found) if found else f"<{iri}>"


def prefixed(iri: str, prefixes: Mapping[str, str] = PREFIXES) -> tuple[str, str] | None:
    """Return prefix and local name of an IRI, None where no prefix fits without an escape.

    Of several the one with the longest namespace is taken, the empty prefix only where it has no equal.
    """
    fitting = (
        (prefix, iri[len(namespace) :])
        for prefix, namespace in prefixes.items()
        if iri.startswith(namespace) and _LOCAL.fullmatch(iri, len(namespace))
    )
    return min(fitting, key=lambda one: (len(one[1]), one[0] == ""), default=None)


def is_absolute(iri: str) -> bool:
    """Tell whether an IRI begins with a scheme."""
    return re.match(r"[A-Za-z][A-Za-z0-9+.-]*:", iri) is not None


def resolve(base: str, reference: str) -> str:
    """Return `reference` as an absolute IRI; one that is absolute stays as it is written."""
    if is_absolute(reference):
        return reference
    scheme, authority, path, query, _ = _split(base)
    _, own_authority, own_path, own_query, fragment = _split(reference)
    if own_authority is not None:
        authority, path, query = own_authority, _without_dots(own_path or ""), own_query
    elif not own_path:
        query = query if own_query is None else own_query
    else:
        if not own_path.startswith("/"):
            own_path = _merged(authority, path or "", own_path)
        path, query = _without_dots(own_path), own_query
    return (
        f"{scheme}:"
        + ("" if authority is None else f"//{authority}")
        + (path or "")
        + ("" if query is None else f"?{query}")
        + ("" if fragment is None else f"#{fragment}")
    )


def _split(iri: str) -> tuple[str | None, ...]:
    match = _PARTS.fullmatch(iri)
    return match.groups() if match else (None, None, iri, None, None)


def _merged(authority: str | None, path: str, own: str) -> str:
    return f"/{own}" if authority is not None and not path else path[: path.rfind("/") + 1] + own


def _without_dots(path: str) -> str:
    kept: list[str] = []
    segments = path.split("/")
    for number, segment in enumerate(segments):
        last = number == len(segments) - 1
        if segment == "..":
            if len(kept) > 1 or (kept and kept[0]):
                kept.pop()
            if last:
                kept.append("")
        elif segment != ".":
            kept.append(segment)
        elif last:
            kept.append("")
    return "/".join(kept)
