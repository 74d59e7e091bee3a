"""Contents of graphs in requests: RDF in one of the formats for a single graph."""

from __future__ import annotations

from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING

from pyoxigraph import DefaultGraph, NamedNode, Quad, RdfFormat, parse

from kg.errors import Place, QueryError
from kg.store.files import BYTE_ORDER_MARK, parsing

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


def quads(parts: Iterable[tuple[bytes, str]], graph: NamedNode | DefaultGraph, base: str | None) -> Iterator[Quad]:
    """Yield the triples of parts, each with its media type or the name of its format, as quads of a graph.

    Relative IRIs are resolved against `base`. Blank nodes are new ones; parts do not share them.

    Raises:
        QueryError: KG562 with the place of a syntax error, KG563 for a format that is not for a single graph.
    """
    for number, (content, kind) in enumerate(parts, 1):
        rdf_format = _format(kind)
        name = "content" if number == 1 else f"content of part {number}"
        plain = content.removeprefix(BYTE_ORDER_MARK)
        try:
            with parsing(rdf_format, partial(BytesIO, plain)):
                found = parse(plain, rdf_format, base_iri=base, without_named_graphs=True, rename_blank_nodes=True)
                for quad in found:
                    yield Quad(quad.subject, quad.predicate, quad.object, graph)
        except SyntaxError as error:
            place = Place(name, error.lineno, error.offset)
            raise QueryError("KG562", error.msg, place=place) from error


def _format(name: str) -> RdfFormat:
    """Return the format with a media type, or a file name suffix."""
    plain = name.partition(";")[0].strip().lower()
    found = RdfFormat.from_media_type(plain) if "/" in plain else RdfFormat.from_extension(plain)
    if found is None or (found.supports_datasets and found != RdfFormat.JSON_LD):
        hint = "The formats are text/turtle, application/n-triples, application/rdf+xml and application/ld+json."
        raise QueryError("KG563", f"`{name}` is not a format for one graph", hint=hint)
    return found
