"""Serialization of triples, by the engine's own serializers, which write as they receive triples."""

from __future__ import annotations

import re
from typing import IO, TYPE_CHECKING, Final, cast

import pyoxigraph
from pyoxigraph import Literal, RdfFormat, Triple

from kg.errors import QueryError
from kg.query.writing.xml import refuse_unwritable
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


GRAPHS: Final = {
    "turtle": RdfFormat.TURTLE,
    "ntriples": RdfFormat.N_TRIPLES,
    "nquads": RdfFormat.N_QUADS,
    "trig": RdfFormat.TRIG,
    "jsonld": RdfFormat.JSON_LD,
    "rdfxml": RdfFormat.RDF_XML,
}
"""Formats of graphs."""

_WITH_PREFIXES: Final = frozenset({"turtle", "trig", "rdfxml"})
_NAME: Final = re.compile(r"[^\W\d]")
"""First character of a local name in XML; it may be anywhere in the IRI."""


def write_triples(name: str, triples: Iterable[Triple], output: Callable[[bytes], object]) -> None:
    """Write `triples` to `output` in the format `name`, in parts of some kilobytes; an exception of `output` ends it.

    Raises:
        QueryError: KG504 for a triple that the format cannot represent.
    """
    prefixes = dict(PREFIXES) if name in _WITH_PREFIXES else {}
    if name == "rdfxml":
        triples, written = map(_for_xml, triples), output
        # The engine does not escape carriage returns, which an XML parser reads as line feeds.
        output = lambda part: written(part.replace(b"\r", b"&#13;"))  # noqa: E731 - short enough
    try:
        sink = cast("IO[bytes]", _Output(output))
        pyoxigraph.serialize(triples, sink, format=GRAPHS[name], prefixes=prefixes)
    except (OSError, ValueError) as error:
        raise QueryError("KG504", f"{name} cannot hold the answer: {error}", hint="Ask for Turtle.") from error


class _Output:
    """File object for the engine, which uses only these two methods."""

    def __init__(self, take: Callable[[bytes], object]) -> None:
        self._take = take

    def write(self, part: bytes) -> int:
        self._take(bytes(part))
        return len(part)

    def flush(self) -> None:
        """Do nothing, as nothing is buffered."""


def _for_xml(triple: Triple) -> Triple:
    """Return the triple; QueryError KG504 if RDF/XML cannot represent it (RDF 1.1 XML Syntax, section 2.10)."""
    predicate = triple.predicate.value
    tail = re.split(r"[^\w.\-·]", predicate)[-1]
    if not _NAME.search(tail):
        raise QueryError(
            "KG504", f"RDF/XML cannot hold the predicate <{predicate}>, which ends in no name", hint="Ask for Turtle."
        )
    if isinstance(triple.object, Literal) and not triple.object.value.isprintable():
        refuse_unwritable(triple.object.value)
    return triple
