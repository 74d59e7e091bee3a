"""`kg query`: SPARQL typed, from a file, or stored under a name."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.options import Format, Json, Limit, Store, Timeout
from kg.cli.output import terminal
from kg.cli.session import session
from kg.errors import Place, UsageError
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.cli.links import Links
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["query"]

Text = Annotated[
    str | None,
    typer.Argument(metavar="QUERY", help="SPARQL, or the name of a stored query; - reads it from standard input."),
]
File = Annotated[Path | None, typer.Option("--file", "-f", metavar="FILE", help="Read the query from FILE.")]


def query(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    text: Text = None,
    *,
    file: File = None,
    format_name: Format = None,
    limit: Limit = None,
    timeout: Timeout = None,
    json: Json = False,
    store: Store = None,
) -> None:
    """Ask the store in SPARQL 1.1.

    The prefixes ros, rnkg, rdf, rdfs, owl, xsd, prov, dcterms, skos, schema and sh are known; the default graph is
    the union of all graphs. Formats of rows: table, tsv, csv, json, xml, markdown, jsonl; of graphs: turtle,
    ntriples, nquads, trig, jsonld, rdfxml. For example:

        kg query 'SELECT ?node ?topic { ?n rnkg:publishes/rdfs:label ?topic ; rnkg:name ?node }'
        kg query -f mine.rq --format csv > answer.csv
    """
    from kg.cli.answers import answer, format_for  # noqa: PLC0415 - start-up time
    from kg.query.core import run  # noqa: PLC0415 - start-up time

    settings = session(context).settings(store=store, format=format_name, limit=limit, timeout=timeout)
    chosen = "jsonl" if json else format_for(settings.format)
    typed, place = _text(text, file)
    with reading(settings) as snapshot:
        result = run(snapshot, typed, timeout=settings.timeout or None, limit=_limit(settings, chosen), path=place)
        links = _links(snapshot) if chosen == "table" and terminal() else None
    answer(result, chosen, links=links, automatic=settings.format == "auto" and not json)


def _links(snapshot: "EmbeddedSnapshot") -> "Links":
    from kg.cli.links import Links  # noqa: PLC0415 - start-up time
    from kg.graph.source_states import sources  # noqa: PLC0415 - start-up time

    return Links.of(sources(snapshot))


def _limit(settings: "Settings", chosen: str) -> int | None:
    """Return the cap of rows: the default one is for tables, which people read; one that was asked for is for all."""
    asked = settings.origin("limit").kind != "default"
    return (settings.limit or None) if asked or chosen == "table" else None


def _text(text: str | None, file: Path | None) -> tuple[str, str]:
    """Return the query and the name of the place it comes from."""
    if (text is None) == (file is None):
        raise UsageError("KG003", "give a query or a file with one", hint="See `kg query --help`.")
    if text == "-" or str(file) == "-":
        return sys.stdin.read(), "standard input"
    if file is None:
        return text or "", "query"
    try:
        return file.read_text(encoding="utf-8"), str(file)
    except OSError as error:
        raise UsageError(
            "KG003", f"cannot be read: {error.strerror}", place=Place(str(file)), hint="Check the path."
        ) from error
    except UnicodeDecodeError as error:
        raise UsageError("KG003", "is not UTF-8 text", place=Place(str(file)), hint="Save it as UTF-8.") from error
