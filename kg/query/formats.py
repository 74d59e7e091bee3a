"""Serialization of results by name of format: the W3C formats of results and graphs, tables, and line-based formats.

Results are written as a stream (`write_rows`, `write_graph`) or whole (`write`), by the same writers
(`kg.query.writing`).
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.errors import QueryError
from kg.query.result import Boolean, Graph, Result, Row
from kg.query.writing import parquet
from kg.query.writing.rows import BOOLEANS, ROWS
from kg.store.serialization import FORMATS, write_serialized
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pyoxigraph import Triple


SOLUTION_FORMATS: Final = ROWS
"""Formats of rows."""

BOOLEAN_FORMATS: Final = BOOLEANS
"""Formats of booleans."""

GRAPH_FORMATS: Final = FORMATS
"""Formats of graphs."""


class Format(NamedTuple):
    """A format: its name, its label, the ending of its files, and its media types, the preferred one first.

    `registered` is its name at W3C (https://www.w3.org/ns/formats/), `aliases` are other names.
    """

    name: str
    label: str
    ending: str
    media: tuple[str, ...]
    registered: str = ""
    aliases: tuple[str, ...] = ()


_RESULTS: Final = "application/sparql-results"
OF_RESULTS: Final = (
    Format("json", "JSON", ".json", (f"{_RESULTS}+json", "application/json"), "SPARQL_Results_JSON", ("srj",)),
    Format("xml", "XML", ".xml", (f"{_RESULTS}+xml", "application/xml", "text/xml"), "SPARQL_Results_XML", ("srx",)),
    Format("csv", "CSV", ".csv", ("text/csv",), "SPARQL_Results_CSV"),
    Format("tsv", "TSV", ".tsv", ("text/tab-separated-values",), "SPARQL_Results_TSV"),
    Format("jsonl", "JSON Lines", ".jsonl", ("application/x-ndjson",), aliases=("ndjson",)),
    Format("markdown", "Markdown", ".md", ("text/markdown",), aliases=("md",)),
    Format(parquet.NAME, "Parquet", ".parquet", ("application/vnd.apache.parquet",)),
)
"""Formats of rows and booleans, the preferred one first; there is no Parquet of booleans."""
OF_GRAPHS: Final = (
    Format("turtle", "Turtle", ".ttl", ("text/turtle", "application/x-turtle"), "Turtle", ("ttl", "n3")),
    Format("ntriples", "N-Triples", ".nt", ("application/n-triples", "text/plain"), "N-Triples", ("nt", "n-triples")),
    Format("jsonld", "JSON-LD", ".jsonld", ("application/ld+json", "application/json"), "JSON-LD", ("json-ld",)),
    Format(
        "rdfxml",
        "RDF/XML",
        ".rdf",
        ("application/rdf+xml", "application/xml", "text/xml"),
        "RDF_XML",
        ("rdf", "rdf/xml", "rdf+xml"),
    ),
    Format("trig", "TriG", ".trig", ("application/trig",), "TriG"),
    Format("nquads", "N-Quads", ".nq", ("application/n-quads",), "N-Quads", ("nq", "n-quads")),
)
"""Formats of graphs, the preferred one first."""
BY_NAME: Final = {one.name: one for one in (*OF_RESULTS, *OF_GRAPHS)}
ALIASES: Final = {alias: one.name for one in BY_NAME.values() for alias in one.aliases}
"""Other names of formats; N3 is read as Turtle, a subset of it."""

_WITH_PREFIXES: Final = frozenset({"turtle", "trig", "rdfxml"})

_KINDS: Final[dict[str, tuple[str, Iterable[str]]]] = {
    "rows": ("rows", ROWS),
    "graph": ("a graph", GRAPH_FORMATS),
    "boolean": ("a boolean", BOOLEANS),
}
"""The noun and the formats of each kind of result."""

_AT_A_TIME: Final = 64
"""Number of rows written together; larger batches are not faster."""


def write(result: Result, name: str) -> bytes:
    """Return `result` in the format `name`.

    Raises QueryError: KG504 with the formats of this kind of result.
    """
    parts: list[bytes] = []
    if isinstance(result, Graph):
        write_graph(name, result.triples, parts.append)
    elif isinstance(result, Boolean):
        write_boolean(name, parts.append, value=result.value)
    else:
        write_rows(name, result.variables, result.rows, parts.append)
    return b"".join(parts)


def write_rows(name: str, variables: tuple[str, ...], rows: Iterable[Row], output: Callable[[bytes], object]) -> None:
    """Write rows to `output` in the format `name`, in batches as they arrive; Parquet is written at the end.

    Raises QueryError: KG504 if the format is not one of rows, cannot represent one of them, or is Parquet without
    pyarrow.
    """
    if name == parquet.NAME:
        output(parquet.written(variables, rows))
        return
    chosen = ROWS.get(name)
    if chosen is None:
        raise unfit("rows", name)
    output(chosen.head(variables))
    remaining = iter(rows)
    separator = b""
    while some := list(islice(remaining, _AT_A_TIME)):
        output(separator + chosen.rows(variables, some))
        separator = chosen.separator
    output(chosen.tail)


def write_graph(name: str, triples: Iterable[Triple], output: Callable[[bytes], object]) -> None:
    """Write triples to `output` in the format `name`, in parts of some kilobytes as they arrive.

    Raises QueryError: KG504 if the format is not one of graphs, or cannot represent one of them.
    """
    if name not in GRAPH_FORMATS:
        raise unfit("graph", name)
    write_serialized(triples, GRAPH_FORMATS[name], PREFIXES if name in _WITH_PREFIXES else {}, output)


def write_boolean(name: str, output: Callable[[bytes], object], *, value: bool) -> None:
    """Write a boolean to `output` in the format `name`; QueryError KG504 if it is not a format of booleans."""
    if name not in BOOLEANS:
        raise unfit("boolean", name)
    output(BOOLEANS[name]("true" if value else "false"))


def unfit(kind: str, *names: str) -> QueryError:
    """Return KG504 for formats `names` that cannot represent a result of this kind: `rows`, `graph` or `boolean`."""
    noun, able = _KINDS[kind]
    formats = [*able, parquet.NAME] if kind == "rows" else list(able)
    given = " and ".join(f"`{name}`" for name in names)
    return QueryError(
        "KG504", f"{given} cannot represent {noun}", hint=f"Use {', '.join(formats[:-1])} or {formats[-1]}."
    )
