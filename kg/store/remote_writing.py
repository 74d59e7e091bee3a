"""A transaction on a SPARQL server: operations are gathered and sent as one request."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import DefaultGraph, RdfFormat, parse, serialize

from kg.errors import GraphError, Place, SourceError, StoreError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from pyoxigraph import NamedNode, Quad

__all__ = ["RemoteTransaction"]


class RemoteTransaction:
    """Operations of SPARQL Update in the order of the calls; see `kg.store.interface.Transaction`."""

    def __init__(self) -> None:
        self._operations: list[str] = []
        self._prefixes: dict[str, str] = {}

    @property
    def operations(self) -> str:
        """The text of one request, empty without operations."""
        # Declarations are at the beginning: Oxigraph 0.5 does not parse those behind a semicolon.
        declared = "".join(f"PREFIX {prefix}: <{iri}>\n" for prefix, iri in self._prefixes.items())
        return declared + " ;\n".join(self._operations) if self._operations else ""

    def replace_graphs(self, graphs: Mapping[NamedNode, Iterable[bytes]]) -> None:
        """Give each named graph a new content, as chunks of N-Triples that end at ends of lines."""
        for graph, chunks in graphs.items():
            self.drop_graph(graph)
            self.append(graph, b"".join(chunks))

    def append(self, graph: NamedNode, triples: bytes) -> None:
        """Add N-Triples to a graph; their blank nodes are new ones in the store."""
        if not triples.strip():
            return
        if b"_:" in triples:
            # One request must not have a label in two of its operations (SPARQL 1.1, grammar note 10).
            renamed = parse(triples, RdfFormat.N_TRIPLES, rename_blank_nodes=True)
            triples = serialize((quad.triple for quad in renamed), format=RdfFormat.N_TRIPLES) or b""
        self._operations.append(f"INSERT DATA {{ GRAPH {graph} {{\n{triples.decode()}}} }}")

    def drop_graph(self, graph: NamedNode) -> None:
        """Remove a graph and its content; an unknown name is ignored."""
        self._operations.append(f"DROP SILENT GRAPH {graph}")

    def load_file(self, path: Path, rdf_format: RdfFormat | None = None, *, graph: NamedNode | None = None) -> None:
        """Add the content of a file of RDF: into `graph`, or into the graphs that the file names.

        Raises:
            GraphError: KG601 with the line when the file is not valid, or when its format cannot be told.
            SourceError: KG101 when the file cannot be opened.
        """
        place = Place(str(path))
        rdf_format = rdf_format or RdfFormat.from_extension(path.suffix.lstrip("."))
        if rdf_format is None:
            hint = "Name the format with `--format`."
            raise GraphError("KG601", f"the format of `{path.name}` is not known", place=place, hint=hint)
        try:
            quads = list(
                parse(path.read_bytes(), rdf_format, base_iri=path.absolute().as_uri(), rename_blank_nodes=True)
            )
        except OSError as error:
            raise SourceError("KG101", f"cannot be opened: {error.strerror}", place=place) from error
        except SyntaxError as error:
            raise GraphError("KG601", error.msg, place=Place(str(path), error.lineno, error.offset)) from error
        self._operations.append("INSERT DATA {\n" + "".join(_stated(quad, graph) for quad in quads) + "}")

    def update(self, text: str, *, prefixes: Mapping[str, str] | None = None) -> None:
        """Add operations of SPARQL Update.

        Raises:
            StoreError: KG225 when a prefix stands for another IRI than in an update of this transaction before.
        """
        for prefix, iri in (prefixes or {}).items():
            if self._prefixes.setdefault(prefix, iri) != iri:
                message = f"the prefix `{prefix}:` means two IRIs in one transaction"
                raise StoreError("KG225", message, hint="Write one of them in full.")
        self._operations.append(text)


def _stated(quad: Quad, graph: NamedNode | None) -> str:
    named = graph if quad.graph_name == DefaultGraph() else quad.graph_name
    return f"GRAPH {named} {{ {quad.triple} }}\n" if named else f"{quad.triple} .\n"
