"""`kg query`: SPARQL typed, from a file, or stored under a name."""

import shlex
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.completion import queries as query_names
from kg.cli.diagnostics import note
from kg.cli.options import Json, from_setting, takes
from kg.cli.output import Column, json_lines, listing, terminal, write
from kg.cli.query_text import pairs, resolve_query
from kg.cli.session import session
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import DECLARED, Settings
from kg.store.opening import reading_all

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.query.stored import StoredQuery
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from pyoxigraph import Literal

    from kg.cli.answers import answer, format_for, is_empty
    from kg.cli.links import Links
    from kg.cli.progress import waiting
    from kg.graph.source_states import sources
    from kg.pipeline.on_demand import with_family
    from kg.query.core import ask, suggestion
    from kg.query.evaluation import prepare
    from kg.query.stored import TermText, discover
    from kg.query.terms import unknown_terms
    from kg.views import whole
    from kg.views.stored import query_object


Text = Annotated[
    str | None,
    typer.Argument(
        metavar="QUERY",
        help="SPARQL, or the name of a stored query; - reads it from standard input.",
        autocompletion=query_names,
    ),
]
Parameter = Annotated[
    list[str] | None,
    typer.Option(
        "--param", metavar="NAME=VALUE", help="Set a variable to a text, or with NAME:=TERM to a term; may be repeated."
    ),
]
Listed = Annotated[bool, typer.Option("--list", "-l", help="List the stored queries.")]
HelpQuery = Annotated[bool, typer.Option("--help-query", help="Show the purpose and parameters of the stored query.")]
OnDemand = Annotated[
    str | None,
    typer.Option(
        "--on-demand", metavar="FAMILY", help="Also use the rules of this family, evaluated for this query only."
    ),
]
File = Annotated[str | None, typer.Option("--file", "-f", metavar="FILE", help="Read the query from FILE.")]
Stores = Annotated[
    list[str] | None, from_setting("store", also="May be repeated: the query sees the union of all stores.")
]


@takes(DECLARED[one] for one in ("format", "limit", "timeout", "queries", "rules"))
def query(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    text: Text = None,
    *,
    file: File = None,
    param: Parameter = None,
    on_demand: OnDemand = None,
    listed: Listed = False,
    help_query: HelpQuery = False,
    json: Json = False,
    store: Stores = None,
    **given: str | None,
) -> None:
    """Run a SPARQL query or a stored query.

    Supports all of SPARQL 1.1 Query. The prefixes ros, rnkg, rdf, rdfs, owl, xsd, prov, dcterms, skos, schema and sh
    are predefined. The default graph is the union of all graphs. Formats of rows: table, tsv, csv, json, xml,
    markdown, jsonl, parquet (an extra); of graphs: turtle, ntriples, nquads, trig, jsonld, rdfxml.

    A value of --param is a text, or of the type that a stored query declares. A term is written NAME:=TERM, as in
    Turtle: <urn:a>, ros:Node, 42, true, "text"@en, "2026-01-01"^^xsd:date. The exit code is 0 for every result, also
    for an empty one and for the answer no.

    Use --on-demand FAMILY for rules whose results are too many to store. The answer is the same as if they were
    stored, but only what the query needs is derived. For example:

        kg query 'SELECT ?node ?topic { ?node rnkg:publishes/rdfs:label ?topic }'
        kg query -f mine.rq --format csv > answer.csv
        kg query --list
        kg query who-publishes --param topic=cmd_vel
        kg query 'SELECT ?node { ?node a ?class }' --param class:=ros:Node
        kg query --store mine --store theirs who-publishes --param topic=cmd_vel
        kg query --on-demand kinship 'SELECT ?who { ?who <urn:x:ancestor> <urn:x:anna> }'
    """
    stores = store or ()
    settings = session(context).settings(store=stores[-1] if stores else None, **given)
    if listed:
        stored_queries = discover(settings.queries).values()
        listing(COLUMNS, list_rows(stored_queries), objects=map(query_object, stored_queries) if json else None)
        if terminal() and not json:
            note("`kg query NAME --help-query` shows one")
        return
    resolved = resolve_query(text, Path(file) if file else None, settings)
    if help_query:
        if json:
            json_lines([query_object(resolved)])
        else:
            write("\n".join(manual(resolved)))
        return
    _answer(resolved, pairs(param or []), settings, stores, on_demand, json=json)


def _answer(  # noqa: PLR0913 - the options of a query
    resolved: "StoredQuery",
    values: dict[str, str],
    settings: Settings,
    stores: "Sequence[str]",
    family: str | None,
    *,
    json: bool,
) -> None:
    chosen = "jsonl" if json else format_for(settings.format)
    timeout = settings.timeout or None
    with reading_all(settings, stores) as stored, _extended(stored, resolved, values, settings, family) as snapshot:
        # The default limit is for tables, which people read; one that was asked for is for all formats.
        is_limited = chosen == "table" or settings.origin("limit").kind != "default"
        limit = (settings.limit or None) if is_limited else None
        plain = not (family or values or resolved.parameters or len(stores) > 1)
        stored_answer = whole.answer(snapshot, resolved.text, timeout=timeout, limit=limit) if plain else None
        result = (
            ask(snapshot, resolved, values, timeout=timeout, limit=limit) if stored_answer is None else stored_answer
        )
        suggestions: list[str] = []
        if is_empty(result):
            value = suggestion(snapshot, resolved, values, timeout=timeout) if values else None
            suggestions = [*_terms(resolved, values), *([value] if value else unknown_terms(snapshot, resolved.text))]
        links = Links.of(sources(snapshot)) if chosen == "table" and terminal() else None
    answer(result, chosen, links=links, automatic=settings.format == "auto" and not json)
    for sentence in suggestions:
        note(sentence)


@contextmanager
def _extended(
    snapshot: "EmbeddedSnapshot",
    resolved: "StoredQuery",
    values: dict[str, str],
    settings: Settings,
    family: str | None,
) -> "Iterator[EmbeddedSnapshot]":
    """Yield the snapshot to ask: with a family, one that has what its rules derive for the query."""
    if family is None:
        yield snapshot
        return

    bound = prepare(resolved.text, resolved.bind(values), str(resolved.path)).bound
    with ExitStack() as stack:
        with waiting(f"deriving by the rules of {family}"):
            extended, derived = stack.enter_context(with_family(settings, snapshot, family, bound))
        if derived.whole:
            note(f"the query can match any predicate: all rules of {family} were evaluated")
        elif terminal():
            note(f"{count(len(derived.facts), 'triple')} derived by {family} in {derived.seconds:.2f} s")
        yield extended


def _terms(resolved: "StoredQuery", values: dict[str, str]) -> "Iterator[str]":
    """Yield a sentence for each text that is a term in Turtle, which may have been meant."""
    for name, value in values.items():
        term = resolved.bind({name: value})[name]
        if isinstance(value, TermText) or not isinstance(term, Literal):
            continue
        written = f"<{value}>" if "://" in value and not value.startswith(("<", '"', "'")) else value
        if resolved.read_term(written) not in {None, term}:
            yield f"?{name} is the text {term}; for the term write --param {name}:={shlex.quote(written)}"


COLUMNS = (Column("query", "name"), Column("answers"), Column("parameters", spare=1))


def list_rows(queries: "Iterable[StoredQuery]") -> list[tuple[str, str, str]]:
    """Return a row for each query: name, purpose, parameters."""
    return [(one.name, one.title, " ".join(parameter.name for parameter in one.parameters)) for one in queries]


def manual(query: "StoredQuery") -> "Iterator[str]":
    """Yield the lines about one query, ending with its text."""
    yield f"{query.name}: {query.title}"
    if query.description:
        yield ""
        yield query.description
    if query.parameters:
        yield ""
        yield "Parameters:"
        longest = max(len(one.name) for one in query.parameters)
        for one in query.parameters:
            default = f", by default {one.default}" if one.default else ""
            yield f"  {one.name:<{longest}}  {one.description} ({one.type}{default})"
        first = query.parameters[0]
        yield ""
        yield "For example:"
        yield f"  kg query {query.name} --param {first.name}={shlex.quote(first.example)}"
    yield ""
    lines = [line for line in query.text.splitlines() if not line.startswith("#")]
    yield from "\n".join(lines).strip().splitlines()
