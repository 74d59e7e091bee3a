"""Serialization of triples and quads by the engine, without what a format cannot represent.

The engine writes whatever it receives: element names that XML does not allow, control characters, triple terms in N3.
So statements in formats with such limits are checked first.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import IO, TYPE_CHECKING, Final, NoReturn, cast

import pyoxigraph
from pyoxigraph import BlankNode, Literal, Quad, RdfFormat, Triple

from kg.errors import QueryError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from kg.store.terms import Term

FORMATS: Final = {
    "turtle": RdfFormat.TURTLE,
    "ntriples": RdfFormat.N_TRIPLES,
    "nquads": RdfFormat.N_QUADS,
    "trig": RdfFormat.TRIG,
    "jsonld": RdfFormat.JSON_LD,
    "rdfxml": RdfFormat.RDF_XML,
}
"""The formats of graphs by their names in `kg`."""

_LIMITED: Final = frozenset({RdfFormat.JSON_LD, RdfFormat.N3, RdfFormat.RDF_XML})
"""Formats that cannot represent every triple."""
_RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
_XMLNS: Final = "http://www.w3.org/2000/xmlns/"
_RESERVED: Final = frozenset(
    _RDF + name
    for name in (
        *("RDF", "ID", "about", "parseType", "resource", "nodeID", "datatype", "Description", "li"),
        *("aboutEach", "aboutEachPrefix", "bagID"),
    )
)
"""Terms of the syntax (RDF 1.1 XML Syntax, section 5.1)."""
_START: Final = (
    "A-Z_a-z\xc0-\xd6\xd8-\xf6\xf8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c\u200d\u2070-\u218f\u2c00-\u2fef"
    "\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
_LOCAL_NAME: Final = f"[{_START}][{_START}\\-.0-9\xb7\u0300-\u036f\u203f\u2040]*\\Z"
"""The local name of an element at the end of an IRI (NCName in Namespaces in XML 1.0, section 3)."""
_UNWRITABLE: Final = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
"""Characters that XML 1.0 does not allow, not even as a reference (section 2.2)."""
_SHOWN: Final = 200
"""Characters of a triple in an error."""


def forbidden_in_xml(text: str) -> str | None:
    """Return why XML cannot represent a text, None if it can."""
    if text.isprintable() or (match := _UNWRITABLE.search(text)) is None:
        return None
    return f"U+{ord(match.group()):04X} is not allowed in XML"


def serialized(statements: Iterable[Triple | Quad], rdf_format: RdfFormat, prefixes: Mapping[str, str]) -> bytes:
    """Return `statements` in a format; raises as `write_serialized`."""
    parts: list[bytes] = []
    write_serialized(statements, rdf_format, prefixes, parts.append)
    return b"".join(parts)


def write_serialized(
    statements: Iterable[Triple | Quad],
    rdf_format: RdfFormat,
    prefixes: Mapping[str, str],
    output: Callable[[bytes], object],
) -> None:
    """Write `statements` to `output` in parts of some kilobytes; an exception of `output` ends it.

    Raises:
        QueryError: KG504 with the first triple that the format cannot represent, and the formats that can.
    """
    if rdf_format in _LIMITED:
        statements = _checked(statements, rdf_format)
    if rdf_format == RdfFormat.RDF_XML:
        written = output
        # The engine does not escape carriage returns, which an XML parser reads as line feeds.
        output = lambda part: written(part.replace(b"\r", b"&#13;"))  # noqa: E731 - short enough
    file = cast("IO[bytes]", _Output(output))
    pyoxigraph.serialize(statements, file, format=rdf_format, prefixes=dict(prefixes))  # type: ignore[arg-type] # triples or quads


class _Output:
    """File object for the engine, which uses only these two methods."""

    def __init__(self, take: Callable[[bytes], object]) -> None:
        self._take = take

    def write(self, part: bytes) -> int:
        self._take(bytes(part))
        return len(part)

    def flush(self) -> None:
        """Do nothing, as nothing is buffered."""


def _checked(statements: Iterable[Triple | Quad], rdf_format: RdfFormat) -> Iterator[Triple | Quad]:
    for statement in statements:
        triple = statement.triple if isinstance(statement, Quad) else statement
        reason = _obstacle(triple, rdf_format)
        if reason is not None:
            _refuse(triple, rdf_format, reason)
        yield _with_xml_labels(triple) if rdf_format == RdfFormat.RDF_XML else statement


def _refuse(triple: Triple, rdf_format: RdfFormat, reason: str) -> NoReturn:
    shown = str(triple)
    shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}..."
    able = [name for name, other in FORMATS.items() if other not in _LIMITED or _obstacle(triple, other) is None]
    hint = f"Use {', '.join(able[:-1])} or {able[-1]}."
    raise QueryError("KG504", f"{rdf_format.name} cannot represent the triple {shown}: {reason}", hint=hint)


def _obstacle(triple: Triple, rdf_format: RdfFormat) -> str | None:
    """Return why one of the limited formats cannot represent a triple, None if it can."""
    if rdf_format == RdfFormat.RDF_XML:
        return _obstacle_in_xml(triple)
    if isinstance(triple.object, Triple):
        return "its object is a triple term"
    if rdf_format == RdfFormat.N3 and isinstance(triple.object, Literal) and triple.object.direction is not None:
        return "its object has a base direction"
    return None


def _obstacle_in_xml(triple: Triple) -> str | None:
    value = triple.object
    if isinstance(value, Literal):
        return _obstacle_to_element(triple.predicate.value) or forbidden_in_xml(value.value)
    if isinstance(value, Triple):
        return _obstacle_to_element(triple.predicate.value) or _obstacle_in_xml(value)
    # The engine writes the class of a resource as the name of its element.
    is_class = triple.predicate.value == _RDF + "type" and not isinstance(value, BlankNode)
    return _obstacle_to_element(value.value if is_class else triple.predicate.value)


@lru_cache(1024)
def _obstacle_to_element(iri: str) -> str | None:
    """Return why an IRI cannot be the name of an element, None if it can."""
    if iri in _RESERVED or iri.startswith(_XMLNS):
        return f"<{iri}> is reserved in RDF/XML"
    return None if re.search(_LOCAL_NAME, iri) else f"<{iri}> does not end in an XML name"


def _with_xml_labels(triple: Triple) -> Triple:
    """Return the triple with labels of blank nodes that are names of XML, which do not begin with a digit."""
    if isinstance(triple.subject, BlankNode) or isinstance(triple.object, BlankNode | Triple):
        return Triple(_xml_label(triple.subject), triple.predicate, _xml_label(triple.object))  # type: ignore[arg-type] # kinds of terms stay
    return triple


def _xml_label(term: Term) -> Term:
    if isinstance(term, Triple):
        return _with_xml_labels(term)
    # Labels that begin with an underscore get one too, so that different labels stay different.
    return BlankNode(f"_{term.value}") if isinstance(term, BlankNode) and term.value[0] in "_0123456789" else term
