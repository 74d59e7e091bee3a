"""Public API, for use from Python. `import kg` provides these names and loads them on first use.

    import kg

    kg.build(["~/catkin_ws/src"])
    for node in kg.nodes(package="move_base"):
        print(node["node"], [topic["name"] for topic in node["publishes"]])
    kg.infer(rules=["~/my_rules"])
    for row in kg.sparql("SELECT ?node ?name { ?node a ros:Node ; rnkg:name ?name }"):
        print(row.name)

`store` is the folder of a store; by default the settings decide, as on the command line. Errors are `kg.KgError`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from kg import settings
from kg.lazily import lazily
from kg.query import core
from kg.store import opening

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from pyoxigraph import Literal, NamedNode

    from kg.pipeline.report import BuildReport, Report
    from kg.query.result import Result
    from kg.rules.reports import RunReport
    from kg.store.embedded import EmbeddedStore
    from kg.store.rdflib_view import SnapshotDataset

with lazily():
    from kg.graph.reading.nodes import node_records
    from kg.graph.records import instance_object, node_object
    from kg.lint.objects import as_object
    from kg.lint.running import check_store, read_folders
    from kg.pipeline.build import build as run
    from kg.pipeline.inferring import run_on_store
    from kg.pipeline.launching import chosen
    from kg.query.evaluation import prepare
    from kg.rules.engine.limits import Limits
    from kg.search.compose import compose as composed
    from kg.search.compose.results import composed_object
    from kg.search.searching import hit_object, open_search
    from kg.store.rdflib_view import SnapshotDataset as View
    from kg.syntax.lexer import Kind, tokens

__all__ = [
    "build",
    "compose",
    "find",
    "findings",
    "infer",
    "instances",
    "nodes",
    "open_store",
    "rdflib_dataset",
    "sparql",
]


def open_store(store: str | Path | None = None) -> EmbeddedStore:
    """Return an existing store.

    Raises:
        StoreError: KG301 if there is none.
    """
    return opening.existing(settings.load({"store": store}))


def build(
    sources: Sequence[str | Path] = (),
    *,
    store: str | Path | None = None,
    jobs: int | None = None,
    report: Report | None = None,
) -> BuildReport:
    """Build the store from `sources` (folders, git addresses, or files that list them), and return a report.

    A missing store is created. Without sources, those of earlier builds are updated; only changed packages are read.
    `jobs` is the number of processes, `report` is called with the progress.

    Raises:
        SourceError: KG101, KG102, KG103 if a source cannot be read at all.
        StoreError: KG301 without sources and store, KG302 while another process writes, KG304 if the disk is full.
    """
    given = settings.load({"store": store, "jobs": jobs})
    with opening.writable(given, create=bool(sources)) as target:
        return run([str(source) for source in sources], target, given, report, "kg.build")


def compose(  # noqa: PLR0913 - the options of chains
    sources: Sequence[str],
    targets: Sequence[str],
    *,
    using: Sequence[str] = (),
    ros: int | None = None,
    length: int | None = None,
    limit: int = 5,
    store: str | Path | None = None,
) -> list[dict[str, Any]]:
    """Return chains of nodes from any type of `sources` to any of `targets`, as in `kg compose --json`.

    Each contains everything in `using`: nodes, packages, types, words that describe nodes. `ros` is 1 or 2. `length` is
    the largest number of nodes in a chain, by default four, and one more than the best chain has. The best comes first.
    Each has a launch file (docs/compose.md).

    Raises:
        StoreError: KG301 if there is no store.
        UnknownNameError: KG705 for a type that no node has, KG706 if there is no chain, KG707 for a name in `using`.
    """
    from kg.search.compose import Question  # noqa: PLC0415 - only this function needs it

    target = open_store(store)
    question = Question(tuple(sources), tuple(targets), tuple(using), ros, length, limit)
    with target.read() as snapshot:
        answer = composed(snapshot, question, target.layout.cache)
    return [composed_object(chain, rank) for rank, chain in enumerate(answer.chains, 1)]


def find(
    text: str = "",
    *,
    filters: Mapping[str, Sequence[str]] | None = None,
    limit: int = 10,
    store: str | Path | None = None,
) -> list[dict[str, Any]]:
    """Return the nodes that match a description, best first, as in `kg search --json` (docs/formats.md).

    `filters` maps the options of `kg search` to values, `{"subscribes": ["LaserScan"]}`; nodes have to match all of
    them. At most `limit` hits are returned, each with reasons.

    Raises:
        StoreError: KG301 if there is no store.
        UsageError: KG701, KG702, KG703 for a name in a filter that no node has.
    """
    search = open_search(open_store(store))
    answer = search.find(text, filters, limit)
    return [hit_object(hit) for hit in answer.hits]


def findings(
    sources: Sequence[str | Path] = (),
    *,
    launch: str | None = None,
    package: str | None = None,
    level: str = "note",
    store: str | Path | None = None,
) -> list[dict[str, Any]]:
    """Return the findings of `kg lint` about the wiring of launch files, as in `kg lint --json` (docs/formats.md).

    The folders `sources` are read first, into a store in the user's cache. Without any, an existing store is checked.
    `launch` and `package` select launch files; `level` (error, warning, note) is the least severity. Findings allowed
    by kg.toml or comments are left out.

    Raises:
        SourceError: KG101 if a folder cannot be read.
        StoreError: KG301 without sources and store.
        UsageError: KG421 for the allow-list, KG422 for the launch file.
    """
    from kg.lint.question import Question  # noqa: PLC0415 - only this function needs it

    folders = [Path(source) for source in sources]
    given = settings.load({"store": store})
    given = read_folders(folders, given)[0] if folders else given
    question = Question(launch=launch, package=package, level=level)
    folder = folders[0] if folders else Path.cwd()
    return [as_object(one) for one in check_store(given, question, folder.absolute()).report.findings]


def infer(
    *,
    rules: Sequence[str | Path] | None = None,
    full: bool = False,
    dry_run: bool = False,
    timeout: float | None = None,
    store: str | Path | None = None,
) -> RunReport:
    """Run the enabled rules, write the inferred triples into the store, and return a report.

    `rules` are folders of rules in addition to those of `kg`, by default those of the settings. Only the effects of
    changes since the last run are evaluated, with `full` everything. With `dry_run` nothing is written. `timeout` is in
    seconds.

    Raises:
        RuleError: KG2xx for rules that cannot be read or run, KG205 at the timeout; the store is unchanged.
        StoreError: KG301 if there is no store, KG302 while another process writes.
    """
    given = settings.load({"store": store, "rules": None if rules is None else [str(folder) for folder in rules]})
    return run_on_store(given, full=full, dry_run=dry_run, limits=Limits(deadline=timeout))


def instances(
    launch: str | Path | None = None,
    *,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    store: str | Path | None = None,
) -> list[dict[str, Any]]:
    """Return the nodes that launch files start, as in `kg instances --json` (docs/formats.md).

    By default these are all launch files of the store with their default arguments; `launch` selects one. With
    `arguments` or `environment` it is evaluated again from its source.

    Raises:
        SourceError: KG101 if its source has moved since the build.
        StoreError: KG301 if there is no store.
        UnknownNameError: KG422 for an unknown launch file.
        UsageError: KG003 if the name is ambiguous, an argument is unknown, or there are arguments without a launch
            file.
    """
    given, target = settings.load({"store": store}), open_store(store)
    systems = chosen(given, target, None if launch is None else str(launch), arguments or {}, environment or {})
    return [instance_object(system, one) for system in systems for one in system.instances]


def nodes(*, package: str | None = None, store: str | Path | None = None) -> list[dict[str, Any]]:
    """Return the node types of the store, or of one package, as in `kg nodes --json` (docs/formats.md).

    Raises:
        StoreError: KG301 if there is no store.
    """
    with open_store(store).read() as snapshot:
        return [node_object(record) for record in node_records(snapshot, package=package)]


def rdflib_dataset(store: str | Path | None = None) -> SnapshotDataset:
    """Return the current store as a read-only rdflib `Dataset` over all graphs, with the usual prefixes bound.

    Close it, or use it in a `with` statement. Until then it shows the same data, which stays on disk. The dataset
    itself and its queries see the union of all graphs; its `default_graph` is the unnamed one, empty in most stores.

    Raises:
        StoreError: KG301 if there is no store.
    """
    from kg.syntax.names import PREFIXES  # noqa: PLC0415 - rdflib takes a quarter of a second to load

    def prepared(text: str, values: Mapping[str, NamedNode | Literal]) -> str:
        used = {token.text[1:] for token in tokens(text) if token.kind is Kind.VARIABLE}
        return prepare(text, {name: term for name, term in values.items() if name in used}).bound

    return View(open_store(store).read(), PREFIXES, prepared)


def sparql(
    text: str,
    *,
    parameters: Mapping[str, NamedNode | Literal] | None = None,
    timeout: float | None = None,
    limit: int | None = None,
    store: str | Path | None = None,
) -> Result:
    """Run a SPARQL query over the union of all graphs and return its whole result; the usual prefixes are predefined.

    SELECT returns `Solutions`: iterate over its rows, or call `dicts` or `dataframe`. CONSTRUCT and DESCRIBE return a
    `Graph` of triples, ASK a `Boolean` that can be used as a condition (docs/python.md).

    `parameters` binds variables of the query to terms. `timeout` is in seconds. `limit` limits rows or triples; the
    result records whether there were more.

    Raises:
        QueryError: KG501 syntax error, KG502 refused, KG503 deadline, KG505 parameter, KG516 nested too deeply.
        StoreError: KG301 if there is no store.
    """
    with open_store(store).read() as snapshot:
        return core.run(snapshot, text, parameters=parameters, timeout=timeout, limit=limit)
