"""The public API: what a program does with `kg`; `import kg` offers these names and loads them when they are used.

    import kg

    kg.build(["~/catkin_ws/src"])
    for node in kg.nodes(package="move_base"):
        print(node["node"], [topic["name"] for topic in node["publishes"]])
    kg.infer(rules=["~/my_rules"])
    for row in kg.sparql("SELECT ?node ?name { ?node a ros:Node ; rnkg:name ?name }"):
        print(row.name)

`store` is the folder of a store; without it the settings decide, as on the command line. Errors are `kg.KgError`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from kg import settings
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
    """Return a store that exists.

    Raises:
        StoreError: KG301 when there is none.
    """
    return opening.existing(settings.load({"store": store}))


def build(
    sources: Sequence[str | Path] = (),
    *,
    store: str | Path | None = None,
    jobs: int | None = None,
    report: Report | None = None,
) -> BuildReport:
    """Read `sources` (folders, git addresses, or files that list them) into the store, and return what was done.

    A store is made where there is none. Without sources, those of earlier builds are read again; only what has
    changed is. `jobs` is the number of processes, `report` is told of the progress.

    Raises:
        SourceError: KG101, KG102, KG103 when a source cannot be read at all.
        StoreError: KG301 without sources and store, KG302 while another process writes, KG304 when the disk is full.
    """
    from kg.pipeline.build import build as run  # noqa: PLC0415 - who only asks loads no reader of sources

    given = settings.load({"store": store, "jobs": jobs})
    with opening.writable(given, create=bool(sources)) as target:
        return run([str(source) for source in sources], target, given, report, "kg.build")


def compose(  # noqa: PLR0913 - what chains may be asked for by
    sources: Sequence[str],
    targets: Sequence[str],
    *,
    using: Sequence[str] = (),
    ros: int | None = None,
    length: int | None = None,
    limit: int = 5,
    store: str | Path | None = None,
) -> list[dict[str, Any]]:
    """Return chains of nodes from any type of `sources` to any of `targets`, as `kg compose --json` writes them.

    Each goes through everything that `using` names: nodes, packages, types, words of what nodes are about. `ros` is 1
    or 2, `length` how many nodes a chain may have; by default four, and one more than the best has. The best comes
    first, each has its launch file (docs/compose.md).

    Raises:
        StoreError: KG301 when there is no store.
        UnknownNameError: KG705 for a type that no node has, KG706 when there is no chain, KG707 for a name in `using`.
    """
    from kg.search.compose import Question  # noqa: PLC0415 - who asks otherwise needs none of it
    from kg.search.compose import compose as composed  # noqa: PLC0415 - the same
    from kg.search.compose.results import composed_object  # noqa: PLC0415 - the same

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
    """Return the nodes that do what a text says, best first, as `kg search --json` writes them (docs/formats.md).

    `filters` has the values of the options of `kg search` by their names, `{"subscribes": ["LaserScan"]}`; nodes have
    to fulfil all of them. There are at most `limit` hits, each with its reasons.

    Raises:
        StoreError: KG301 when there is no store.
        UsageError: KG701, KG702, KG703 for the name in a filter that no node has.
    """
    from kg.search.searching import hit_object, open_search  # noqa: PLC0415 - who asks otherwise needs no index

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
    """Return what is wrong in the wiring of launch files, as `kg lint --json` writes it (docs/formats.md).

    The folders `sources` are read first, into a store of their own in the user's cache; without any, the findings are
    those of a store. `launch` and `package` choose launch files, `level` (error, warning, note) leaves out what is
    less. So is what kg.toml and comments allow.

    Raises:
        SourceError: KG101 when a folder cannot be read.
        StoreError: KG301 without sources and store.
        UsageError: KG421 for the allow-list, KG422 for the launch file.
    """
    from kg.lint.objects import as_object  # noqa: PLC0415 - who asks otherwise needs none of it
    from kg.lint.question import Question  # noqa: PLC0415 - the same
    from kg.lint.running import check_store, read_folders  # noqa: PLC0415 - the same

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
    """Run the rules in force, write what they infer into the store, and return what was done.

    `rules` are folders of rules beside those that `kg` ships, by default those of the settings. What follows from
    changes since the last run is evaluated, with `full` everything; with `dry_run` nothing is written. `timeout` is in
    seconds.

    Raises:
        RuleError: KG2xx for rules that cannot be read or run, KG205 after the timeout; the store is as it was.
        StoreError: KG301 when there is no store, KG302 while another process writes.
    """
    from kg.pipeline.inferring import run_on_store  # noqa: PLC0415 - who only asks loads no engine of rules
    from kg.rules.engine.limits import Limits  # noqa: PLC0415 - the same

    given = settings.load({"store": store, "rules": None if rules is None else [str(folder) for folder in rules]})
    return run_on_store(given, full=full, dry_run=dry_run, limits=Limits(deadline=timeout))


def instances(
    launch: str | Path | None = None,
    *,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    store: str | Path | None = None,
) -> list[dict[str, Any]]:
    """Return what launch files start, as `kg instances --json` writes it (docs/formats.md).

    That is every launch file of the store with its default arguments, or the one that `launch` names. `arguments` and
    environment variables make it be evaluated anew, where its source stands.

    Raises:
        SourceError: KG101 when its source is not where it was built from.
        StoreError: KG301 when there is no store.
        UnknownNameError: KG422 when there is no such launch file.
        UsageError: KG003 when several are meant, it has no such argument, or arguments are given for none.
    """
    from kg.graph.records import instance_object  # noqa: PLC0415 - who queries needs no records
    from kg.pipeline.launching import chosen  # noqa: PLC0415 - the same

    given, target = settings.load({"store": store}), open_store(store)
    found = chosen(given, target, None if launch is None else str(launch), arguments or {}, environment or {})
    return [instance_object(system, one) for system in found for one in system.instances]


def nodes(*, package: str | None = None, store: str | Path | None = None) -> list[dict[str, Any]]:
    """Return the node types of the store, or of one package, as `kg nodes --json` writes them (docs/formats.md).

    Raises:
        StoreError: KG301 when there is no store.
    """
    from kg.graph.reading import node_records  # noqa: PLC0415 - who queries needs no records
    from kg.graph.records import node_object  # noqa: PLC0415 - the same

    with open_store(store).read() as snapshot:
        return [node_object(record) for record in node_records(snapshot, package=package)]


def rdflib_dataset(store: str | Path | None = None) -> SnapshotDataset:
    """Return the store in force as a read-only rdflib `Dataset` over all graphs, with the usual prefixes bound.

    Close it, or use it in a `with` statement: until then it shows the store as it was, and keeps that data on disk.

    Raises:
        StoreError: KG301 when there is no store.
    """
    from kg.store.rdflib_view import SnapshotDataset as View  # noqa: PLC0415 - the same
    from kg.syntax.names import PREFIXES  # noqa: PLC0415 - rdflib takes a quarter of a second to load

    return View(open_store(store).read(), PREFIXES)


def sparql(
    text: str,
    *,
    parameters: Mapping[str, NamedNode | Literal] | None = None,
    timeout: float | None = None,
    limit: int | None = None,
    store: str | Path | None = None,
) -> Result:
    """Run a SPARQL query over the union of all graphs and return its whole answer; the usual prefixes are known.

    SELECT returns `Solutions`: iterate over its rows, or call `dicts` or `dataframe`. CONSTRUCT and DESCRIBE return a
    `Graph` of triples, ASK a `Boolean` that can be used as a condition (docs/python.md).

    `parameters` are terms for variables of the query, `timeout` is in seconds, `limit` caps rows or triples and the
    answer says whether there were more.

    Raises:
        QueryError: KG501 not SPARQL, KG502 refused, KG503 deadline, KG505 parameter, KG516
            too deep.
        StoreError: KG301 when there is no store.
    """
    with open_store(store).read() as snapshot:
        return core.run(snapshot, text, parameters=parameters, timeout=timeout, limit=limit)
