"""`kg export`, `import` and `forget`: RDF out of the store and into it. `kg publish` and `pull`: graphs for others."""

from dataclasses import asdict
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.commands.build import copy_to, server_of
from kg.cli.diagnostics import note, say
from kg.cli.options import Json, NoRules, OutputFile, UpdateUrl, argument, option, with_settings
from kg.cli.output import json_lines, save, terminal, write_bytes
from kg.errors import Exit, QueryError, UsageError
from kg.forms import FormError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.similar import did_you_mean, unknown
from kg.store.opening import existing, mirrored, reading, writable

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    import gzip

    from pyoxigraph import NamedNode, RdfFormat, parse

    from kg.cli.commands.build import left_out
    from kg.forms import size
    from kg.graph.iris import Iris
    from kg.pipeline.forgetting import forget as drop
    from kg.pipeline.inferring import Inference, Inferred
    from kg.pipeline.snapshots import publish as write
    from kg.pipeline.snapshots import pull as fetch
    from kg.pipeline.updating.ownership import protected_graphs
    from kg.query import formats
    from kg.query.writing import parquet
    from kg.rules.reading import user_folders
    from kg.search.searching import open_search


FORMATS: Final = ("nq", "trig", "nt", "ttl", "n3", "rdf", "jsonld")
_PARQUET: Final = "parquet"
FormatName = Annotated[
    str | None, option("--format -f FORMAT", f"{', '.join(FORMATS)}; by default from the file name.")
]
ExportFormat = Annotated[
    str | None,
    option("--format -f FORMAT", f"{', '.join(FORMATS)}, {_PARQUET} (an extra); by default from the file name."),
]
Source = Annotated[str | None, option("--source NAME", "Only facts from this source (see `kg status`).")]
GraphName = Annotated[str | None, option("--graph -g NAME", "A named graph: ontology, inferred, builds, or an IRI.")]
Files = Annotated[list[str], argument("FILE", "RDF files.")]
Sources = Annotated[list[str], argument("SOURCE", "Names of sources, as listed by `kg status`.")]


@with_settings("base", "store")
def export(
    *,
    settings: Settings,
    output: OutputFile = None,
    format_name: ExportFormat = None,
    source: Source = None,
    graph: GraphName = None,
) -> None:
    """Write the graph as RDF, or as a table of quads.

    By default, writes the whole graph as N-Quads. A file that ends in .gz is compressed. Formats without named graphs
    (nt, ttl, n3, rdf) get the union of all graphs. Parquet has the columns subject, predicate, object and graph. For
    example:

        kg export > everything.nq
        kg export --source github.com/acme/rover -o rover.ttl
        kg export -o everything.parquet
    """
    from kg.graph.vocabulary import PREFIXES  # noqa: PLC0415 - start-up time

    target = Path(output) if output else None
    as_table = _ending(format_name, target) == _PARQUET
    rdf_format = None if as_table else _format(format_name, target) or _format("nq", None)
    if as_table and target is None and terminal():
        raise QueryError("KG504", "a terminal cannot show Parquet", hint="Write it to a file: -o graph.parquet")
    with reading(settings) as snapshot:
        chosen = _graph(snapshot, settings.base, source, graph)
        data = snapshot.dump(rdf_format, graph=chosen, prefixes=PREFIXES) if rdf_format else _table(snapshot, chosen)
    if target is None:
        write_bytes(data)
        return
    # Without the time, so that the same data gives the same bytes.
    save(target, gzip.compress(data, mtime=0) if target.suffix == ".gz" else data)
    say(f"wrote {count(len(data), 'byte')} of {rdf_format.name if rdf_format else 'Parquet'} to {target}")


def _table(snapshot: "EmbeddedSnapshot", graph: "NamedNode | None") -> bytes:
    """Return the quads of a graph, or of all, as Parquet."""
    chosen = RdfFormat.N_QUADS
    quads = snapshot.quads() if graph is None else parse(snapshot.dump(chosen, graph=graph), chosen)
    output = BytesIO()
    parquet.write_quads(quads, output)
    return output.getvalue()


@with_settings("base", "store")
def import_files(  # noqa: PLR0913 - the options of a command
    files: Files,
    *,
    settings: Settings,
    format_name: FormatName = None,
    graph: GraphName = None,
    no_rules: NoRules = False,
    update_url: UpdateUrl = None,
) -> None:
    """Add RDF files to the store.

    Files may be compressed (.gz). If one is invalid, nothing is added. Triples go into the graph named with --graph,
    by default one named after the file. Quads keep their graphs. If the store has no ontologies yet, those of kg are
    added. Rules then infer further facts, and remove triples of the graph `inferred` that they do not infer.
    For example:

        kg import everything.nq
        kg import my-robot.ttl --graph https://example.org/my-robot
        kg import my-robot.ttl --store http://localhost:7878/query --update-url http://localhost:7878/update
    """
    server = server_of(settings, update_url)
    if server is not None:
        settings = mirrored(settings)
    iris = Iris(settings.base)
    named = _named(settings.base, graph) if graph is not None else None
    if named in protected_graphs(settings):
        hint = "Leave out --graph, or name another one. Quads of a file keep their graphs."
        raise QueryError("KG561", f"the graph {named} is written by kg alone", hint=hint)
    with writable(settings) as target:
        rdf_format = _format(format_name, None)
        inference = Inference(target, settings)
        with target.write("kg import") as transaction:
            if not no_rules:
                inference.watch(transaction)
            for file in map(Path, files):
                into = named or NamedNode(iris.graph(f"imported-{file.name}"))
                transaction.load_file(file, rdf_format, graph=into)
            inference.update_ontologies(transaction)
            inferred = None if no_rules else inference.run(transaction)
            inference.remember(transaction.commit())
        with target.read() as snapshot:
            say(f"the store now holds {count(snapshot.count(), 'quad')}")
    if server is not None:
        copy_to(server, target)
    if inferred and inferred.removed:
        note(f"{count(inferred.removed, 'inferred triple')} removed: the rules do not infer them from this data")
    _end(inferred)


@with_settings("base", "store")
def forget(sources: Sources, *, settings: Settings, no_rules: NoRules = False) -> None:
    """Remove sources from the store.

    Removes everything read from them, and what rules inferred from it. Their source code is not touched. `kg build`
    adds them again. For example:

        kg forget github.com/acme/rover
    """
    target = existing(settings)
    with target.read() as snapshot:
        for name in sources:
            _graph(snapshot, settings.base, name, None)
    inferred = drop(target, settings, sources, rules=not no_rules)
    say(f"forgot {', '.join(sources)}")
    _end(inferred)


def _end(inferred: "Inferred | None") -> None:
    if left_out(inferred):
        raise typer.Exit(Exit.FOUND)


def _format(name: str | None, output: Path | None) -> "RdfFormat | None":
    """Return the format of that name or of a file's ending; None when neither is given."""
    ending = _ending(name, output)
    if not ending:
        return None
    form = RdfFormat.from_extension(ending) or formats.GRAPH_FORMATS.get(formats.ALIASES.get(ending, ending))
    if "/" in ending:
        form = RdfFormat.from_media_type(ending)
    if form is None:
        near = did_you_mean(ending, FORMATS)
        raise QueryError("KG504", f"unknown format `{ending}`", hint=near or f"The formats are {', '.join(FORMATS)}.")
    return form


def _ending(name: str | None, output: Path | None) -> str:
    ending = output.name.removesuffix(".gz").rpartition(".")[2] if output and output.suffix else ""
    return (name or ending).lower()


def _named(base: str, name: str) -> "NamedNode":
    """Return the graph of a short name or an IRI; UsageError KG003 if it is neither."""
    try:
        return NamedNode(name if ":" in name or not name else f"{base}graph/{name}")
    except ValueError as error:
        hint = "Give a short name such as `notes`, or an IRI."
        raise UsageError("KG003", f"`{name}` cannot name a graph: {error}", hint=hint) from error


def _graph(snapshot: "EmbeddedSnapshot", base: str, source: str | None, graph: str | None) -> "NamedNode | None":
    """Return the graph that the options name; KG001 when the store does not have it."""
    if source and graph:
        raise UsageError("KG003", "--source and --graph are mutually exclusive", hint="Give one of them.")
    if not source and graph is None:
        return None
    wanted = _named(base, Iris(base).source_graph(source) if source else graph or "")
    graphs = snapshot.graphs()
    if wanted in graphs:
        return wanted
    matches = [one.value for one in graphs]
    start = f"{base}graph/source/" if source else f"{base}graph/"
    names = [one.removeprefix(start) for one in matches if one.startswith(start) or not source]
    kind = "source" if source else "graph"
    raise unknown(kind, source or graph or "", names, otherwise=f"There are: {', '.join(names) or 'none'}.")


Target = Annotated[str, argument("TARGET", "A folder, or an address of a web server that accepts PUT.")]
Address = Annotated[str, argument("ADDRESS", "What `kg publish` wrote: http(s)://, file:// or a folder.")]
NoIndex = Annotated[bool, option("--no-index", "Leave out the search index.")]
WithIndex = Annotated[
    bool, option("--index", "Also take the publisher's search index; by default the first search builds one.")
]
MaxBytes = Annotated[str, option("--max-bytes SIZE", "Refuse a snapshot larger than this, packed or unpacked.")]


@with_settings("rules", "base", "store")
def publish(target: Target, *, settings: Settings, no_index: NoIndex = False, json: Json = False) -> None:
    """Write the graph for others, to a folder or a web server.

    Writes the graph as compressed N-Quads, the search index, your own rules, and a manifest with the digest of each.
    What was published there before is replaced. The graph names the folders of its sources on this machine. A web
    server gets the credentials in KG_REMOTE_TOKEN, or KG_REMOTE_USER and KG_REMOTE_PASSWORD. For example:

        kg publish /srv/www/robots
        kg publish https://files.example.org/robots
    """
    opened = existing(settings)
    if not no_index:
        open_search(opened)
    with opened.read() as snapshot:
        index = None if no_index else opened.layout.cache / "search" / snapshot.identity
        manifest = write(snapshot, target, settings.base, user_folders(settings), index)
    if json:
        json_lines([asdict(manifest)])
    say(f"published {count(manifest.quads, 'quad')} with digest {manifest.digest} to {target}")


@with_settings("store")
def pull(
    address: Address, *, settings: Settings, index: WithIndex = False, max_bytes: MaxBytes = "4G", json: Json = False
) -> None:
    """Fetch a published graph and make a store of it.

    Every file is compared with its digest, and the store is unchanged unless all are whole. Pulling again replaces the
    content. Rules of the publisher are kept in STORE/published/rules and are not run unless you name them with --rules.
    A web server gets the credentials in KG_REMOTE_TOKEN, or KG_REMOTE_USER and KG_REMOTE_PASSWORD. For example:

        kg pull https://files.example.org/robots --store robots
        kg query --store robots --store .kg 'SELECT ?node { ?node a ros:Node }'
    """
    try:
        limit = size(max_bytes, Path())
    except FormError as error:
        raise UsageError("KG002", f"--max-bytes is {max_bytes!r}, which is not {error}") from error
    with writable(settings) as target:
        manifest = fetch(address, target, limit, with_index=index)
    if json:
        json_lines([asdict(manifest)])
    say(f"pulled {count(manifest.quads, 'quad')} with digest {manifest.digest} into {target.layout.root}")
    if manifest.rules:
        rules = target.layout.root / "published" / "rules"
        note(f"{count(len(manifest.rules), 'rule')} of the publisher in {rules}; `--rules` runs them")
