"""`kg query`: SPARQL typed, from a file, or stored under a name."""

import re
import shlex
import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.completion import queries as query_names
from kg.cli.diagnostics import note
from kg.cli.options import Json, argument, from_setting, option, session, takes
from kg.cli.output import (
    Column,
    Linked,
    fitted,
    json_lines,
    line_width,
    listing,
    print_table,
    terminal,
    write,
    write_bytes,
)
from kg.errors import QueryError, UsageError
from kg.lazily import lazily
from kg.render.text import count, width
from kg.settings import DECLARED, Settings
from kg.similar import did_you_mean
from kg.store.opening import reading_all

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.query.result import Result
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    from pyoxigraph import Literal

    from kg.cli.links import Links
    from kg.cli.progress import waiting
    from kg.graph.source_states import sources
    from kg.pipeline.on_demand import with_family
    from kg.query.core import ask, suggestion
    from kg.query.evaluation import prepare
    from kg.query.formats import write as written
    from kg.query.result import Boolean, Graph, Solutions
    from kg.query.stored import QueryParameter, StoredQuery, TermText, discover, find, read
    from kg.query.terms import unknown_terms
    from kg.query.writing import parquet
    from kg.query.writing.values import display, plain
    from kg.views import whole
    from kg.views.stored import query_object


Text = Annotated[
    str | None,
    argument(
        "QUERY", "SPARQL, or the name of a stored query; - reads it from standard input.", autocompletion=query_names
    ),
]
Parameter = Annotated[
    list[str] | None,
    option("--param NAME=VALUE", "Set a variable to a text, or with NAME:=TERM to a term; may be repeated."),
]
Listed = Annotated[bool, option("--list -l", "List the stored queries.")]
HelpQuery = Annotated[bool, option("--help-query", "Show the purpose and parameters of the stored query.")]
OnDemand = Annotated[
    str | None, option("--on-demand FAMILY", "Also use the rules of this family, evaluated for this query only.")
]
File = Annotated[str | None, option("--file -f FILE", "Read the query from FILE.")]
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
        columns = (Column("query", "name"), Column("answers"), Column("parameters", spare=1))
        rows = [(one.name, one.title, " ".join(each.name for each in one.parameters)) for one in stored_queries]
        listing(columns, rows, objects=map(query_object, stored_queries) if json else None)
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
        if not (result.value if isinstance(result, Boolean) else len(result)):
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


def format_for(name: str) -> str:
    """Return the format for the setting `format`; `auto` is a table for people and TSV for programs.

    Raises QueryError: KG504 unknown format.
    """
    from kg.query.formats import ALIASES, GRAPH_FORMATS, SOLUTION_FORMATS  # noqa: PLC0415 - start-up time

    if name == "auto":
        return "table" if terminal() else "tsv"
    full = ALIASES.get(name, name)
    formats = ("table", *SOLUTION_FORMATS, parquet.NAME, *GRAPH_FORMATS)
    if full not in formats:
        near = did_you_mean(name, formats)
        raise QueryError("KG504", f"unknown format `{name}`", hint=near or f"The formats are {', '.join(formats)}.")
    return full


def answer(result: "Result", name: str, *, automatic: bool = False, links: "Links | None" = None) -> None:
    """Write a result in a format of `format_for`; an `automatic` format becomes Turtle for a graph.

    Notes report the number of rows to people, and missing rows to everyone.
    """
    if name == "table" and isinstance(result, Solutions):
        table(result, links)
    elif name == "table" and isinstance(result, Boolean):
        write("yes" if result.value else "no")
    elif isinstance(result, Graph) and (automatic or name == "table"):
        write_bytes(written(result, "turtle"))
    elif name == parquet.NAME and terminal():
        hint = "Send it to a file: `kg query ... --format parquet > answer.parquet`."
        raise QueryError("KG504", "a terminal cannot show Parquet", hint=hint)
    else:
        write_bytes(written(result, name))
    if isinstance(result, Boolean):
        return
    rows = count(len(result.rows), "row") if isinstance(result, Solutions) else count(len(result.triples), "triple")
    if result.limit is not None:
        note(f"only the first {rows} shown; --limit 0 shows all")
    elif name == "table":
        note(f"{rows} in {result.seconds:.3f} s")


def table(result: "Solutions", links: "Links | None" = None) -> None:
    """Write rows as a table: numbers aligned right, `?file` and `?line` as one place with a link."""
    if not result.rows:
        return
    has_places = {"file", "line"} <= set(result.variables)
    joined = {name: result.variables.index(name) for name in ("file", "line")} if has_places else {}
    others = [index for index in range(len(result.variables)) if index not in joined.values()]
    columns = []
    for index in others:
        values = [plain(row[index]) for row in result.rows if row[index] is not None]
        numeric = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
        columns.append(Column(result.variables[index], "number" if values and numeric else "text"))
    rows: list[list[object]] = [[display(row[index]) for index in others] for row in result.rows]
    if joined:
        columns.append(Column("file:line", "dim"))
        taken = sum(
            max([width(columns[i].title), *(width(str(row[i])) for row in rows)]) + 3 for i in range(len(others))
        )
        _add_places(rows, result, joined, line_width() - taken, links)
    print_table(columns, rows)


def _add_places(
    rows: list[list[object]], result: "Solutions", at: "Mapping[str, int]", room: int, links: "Links | None"
) -> None:
    places = [(display(row[at["file"]]), display(row[at["line"]])) for row in result.rows]
    shown = fitted([f"{file}:{line}" if line else file for file, line in places], room)
    for row, (file, line), text in zip(rows, places, shown, strict=True):
        address = links.find(file, int(line)) if links and line.isdigit() else None
        row.append(Linked(text, address))


_PAIR: Final = re.compile(r"\s*[?$]?(?P<name>[^=:\s]+)\s*(?P<sign>:?=)(?P<value>.*)", re.DOTALL)
_NAME: Final = re.compile(r"[\w.-]+(/[\w.-]+)*")


def pairs(given: list[str]) -> dict[str, str]:
    """Return the values of parameters given as `name=value`, or as `name:=term`."""
    values: dict[str, str] = {}
    for pair in given:
        match = _PAIR.fullmatch(pair)
        if match is None:
            hint = "Write --param NAME=VALUE, or NAME:=TERM."
            raise UsageError("KG003", f"`{pair}` is not a parameter", hint=hint)
        if match["name"] in values:
            raise UsageError("KG003", f"the parameter {match['name']} is given twice", hint="Give it one value.")
        values[match["name"]] = TermText(match["value"]) if match["sign"] == ":=" else match["value"]
    return values


def resolve_query(text: str | None, file: Path | None, settings: Settings) -> "StoredQuery":
    """Return the query of the arguments: typed, from a file or standard input, or stored under a name."""
    if text is not None and file is not None:
        hint = "Remove one of them; `--format` selects the format of the result."
        raise UsageError("KG003", "QUERY and --file are mutually exclusive", hint=hint)
    if text == "-" or str(file) == "-":
        return _typed(sys.stdin.read().removeprefix("\ufeff"), "standard input")
    if file is not None:
        return read(file, str(file))
    if text is None:
        hint = "For example: `kg query topics`. `kg query --list` lists the stored queries."
        raise UsageError("KG003", "no query given", hint=hint)
    if text and _NAME.fullmatch(text):
        return find(text, settings.queries)
    return _typed(text, "query")


def _typed(text: str, place: str) -> "StoredQuery":
    """Return an ad-hoc query; each of its variables may be a parameter."""
    names = dict.fromkeys(re.findall(r"[?$](\w+)", text))
    parameters = tuple(QueryParameter(name, "string", "", "", None) for name in names)
    return StoredQuery("that was given", Path(place), "", "", parameters, text)
