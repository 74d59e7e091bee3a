"""Triples in each of their formats, by the engine's own serialisers, which write while they are given triples."""

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
"""What a graph can be written as."""

_WITH_PREFIXES: Final = frozenset({"turtle", "trig", "rdfxml"})
_NAME: Final = re.compile(r"[^\W\d]")
"""What the local name of an element of XML begins with, wherever in the IRI that is."""


def write_triples(name: str, triples: Iterable[Triple], output: Callable[[bytes], object]) -> None:
    """Give `triples` to `output` in the format `name`, some kilobytes at a time; what `output` raises ends it.

    Raises:
        QueryError: KG504 for a triple that the format cannot hold.
    """
    prefixes = dict(PREFIXES) if name in _WITH_PREFIXES else {}
    if name == "rdfxml":
        triples, written = map(_for_xml, triples), output
        # The engine leaves carriage returns as they are, which a parser of XML reads as line feeds.
        output = lambda part: written(part.replace(b"\r", b"&#13;"))  # noqa: E731 - three words
    try:
        sink = cast("IO[bytes]", _Output(output))
        pyoxigraph.serialize(triples, sink, format=GRAPHS[name], prefixes=prefixes)
    except (OSError, ValueError) as error:
        raise QueryError("KG504", f"{name} cannot hold the answer: {error}", hint="Ask for Turtle.") from error


class _Output:
    """What the engine writes to: it uses these two methods of a file alone."""

    def __init__(self, take: Callable[[bytes], object]) -> None:
        self._take = take

    def write(self, part: bytes) -> int:
        self._take(bytes(part))
        return len(part)

    def flush(self) -> None:
        """Keep nothing back, so there is nothing to do."""


def _for_xml(triple: Triple) -> Triple:
    """Return the triple; QueryError KG504 when RDF/XML has no way to write it (RDF 1.1 XML Syntax, section 2.10)."""
    predicate = triple.predicate.value
    tail = re.split(r"[^\w.\-·]", predicate)[-1]
    if not _NAME.search(tail):
        raise QueryError(
            "KG504", f"RDF/XML cannot hold the predicate <{predicate}>, which ends in no name", hint="Ask for Turtle."
        )
    if isinstance(triple.object, Literal) and not triple.object.value.isprintable():
        refuse_unwritable(triple.object.value)
    return triple
