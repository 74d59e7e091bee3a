"""`kg nodes`, `packages`, `files`, `topics`, `services` and `actions`: lists over the whole store."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any, Final

from kg.cli.diagnostics import note
from kg.cli.options import All, Json, PackageName, option, require_one_of, with_settings
from kg.cli.output import Column, listing, numbers, terminal, write
from kg.lazily import lazily
from kg.render.text import count, some
from kg.settings import Settings
from kg.similar import unknown
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    from kg.graph.reading import overview
    from kg.graph.reading.nodes import node_records
    from kg.graph.records import node_object
    from kg.views.answers import channels, node_lines, node_summaries
    from kg.views.names import require_package


_UNBOUNDED: Final = 1_000
_SORTS: Final = ("code", "both", "text", "other")


@with_settings("store")
def packages(*, settings: Settings, json: Json = False) -> None:
    """List the packages with their nodes, interfaces and problems.

    Counts the nodes, interface definitions and problems of each package.
    """
    with reading(settings) as snapshot:
        listed = overview.packages(snapshot)
    columns = (
        Column("package", "name"),
        Column("version"),
        *numbers("ros", "nodes", "definitions", "problems"),
        Column("source", "dim", spare=1),
        Column("folder", "dim", spare=1),
    )
    rows = [
        (one.name, one.version, one.ros, one.nodes, one.definitions, one.problems, one.repository, one.folder)
        for one in listed
    ]
    listing(columns, rows, objects=map(asdict, listed) if json else None)
    if terminal() and not json:
        note(count(len(listed), "package"))


Package = Annotated[str | None, option("--package -p NAME", "Only files of this package.")]
Sort = Annotated[str | None, option("--sort SORT", f"Only {', '.join(_SORTS)} files.")]


@with_settings("store")
def files(*, settings: Settings, package: Package = None, sort: Sort = None, json: Json = False) -> None:
    """List the files of packages, sorted into code and text.

    As in RNKG (section 3.1.2), code is C++, Python, interface definitions and launch files; text is READMEs, pages and
    the comments of code (`both`). Manifests, build files and parameters are `other`. Counts the node types made from a
    file, and the descriptions taken from it. For example:

        kg files --package rover_robot
        kg files --sort text
    """
    if sort is not None:
        require_one_of(sort, _SORTS, "sort")
    with reading(settings) as snapshot:
        every = overview.files(snapshot)
    selected = [one for one in every if sort in {None, one.sort} and package in {None, one.package}]
    if package is not None and not selected and package not in {one.package for one in every}:
        raise unknown("package", package, {one.package for one in every}, otherwise="`kg packages` lists them.")
    columns = (
        Column("sort"),
        Column("kind"),
        *numbers("nodes", "texts"),
        Column("package", "name"),
        Column("file"),
        Column("source", "dim", spare=1),
    )
    rows = [(one.sort, one.kind, one.nodes, one.texts, one.package, one.path, one.repository) for one in selected]
    listing(columns, rows, objects=map(asdict, selected) if json else None)
    if terminal() and not json:
        counts = Counter(one.sort for one in selected)
        note(", ".join(f"{counts[one]} {one}" for one in _SORTS if counts[one]) or "no files")


@with_settings("store")
def topics(*, settings: Settings, every: All = False, json: Json = False) -> None:
    """List the topics with their types and numbers of nodes.

    Names are those in launched systems, after remapping, and those of nodes started alone. `kg topic NAME` shows one.
    """
    _list(settings, "topic", every=every, json=json)


@with_settings("store")
def services(*, settings: Settings, every: All = False, json: Json = False) -> None:
    """List the services with their types and numbers of nodes.

    `kg service NAME` shows one.
    """
    _list(settings, "service", every=every, json=json)


@with_settings("store")
def actions(*, settings: Settings, every: All = False, json: Json = False) -> None:
    """List the actions with their types and numbers of nodes.

    `kg action NAME` shows one.
    """
    _list(settings, "action", every=every, json=json)


def _list(settings: Settings, kind: str, *, every: bool, json: bool) -> None:
    with reading(settings) as snapshot:
        rows = [asdict(one) for one in channels(snapshot, kind, implicit=every)]
    channel_rows(kind, rows, json=json)
    if terminal() and not json:
        note(count(len(rows), kind))


def channel_rows(kind: str, listed: "Sequence[Mapping[str, Any]]", *, json: bool = False) -> None:
    """Write topics, services or actions as a list: objects as of `kg.graph.reading.overview.Channel`."""
    verbs = ("publish", "subscribe") if kind == "topic" else ("offer", "call")
    columns = (Column(kind, "name"), Column("type"), *numbers(*verbs, "launch files", spare=1))
    most = 2 if terminal() else _UNBOUNDED  # types in a row
    rows = [
        (one["name"], some(one["types"], most), len(one["givers"]), len(one["takers"]), one["systems"])
        for one in listed
    ]
    givers, takers = (f"{verb}ed_by" if verb[-1] != "e" else f"{verb}d_by" for verb in verbs)
    objects = (
        {
            kind: one["name"],
            "types": one["types"],
            givers: one["givers"],
            takers: one["takers"],
            "systems": one["systems"],
        }
        for one in listed
    )
    listing(columns, rows, objects=objects if json else None)


COLUMNS: Final = (
    Column("package"),
    Column("node", "name"),
    Column("kind", spare=1),
    *numbers("ros", "pub", "sub", "srv", "cli", "act", "par", spare=2),
    Column("file:line", "dim", spare=3),
)
Kind = Annotated[str | None, option("--kind KIND", "Only executable, script, nodelet, component, plugin or class.")]


@with_settings("store")
def nodes(*, settings: Settings, package: PackageName = None, kind: Kind = None, json: Json = False) -> None:
    """List all nodes with the number of their interfaces.

    The columns count what the code itself declares: topics published (pub) and subscribed to (sub), services offered
    (srv) and called (cli), actions offered or called (act), parameters (par). For example:

        kg nodes --package move_base
        kg nodes --json | jq -r 'select(.publishes[].type == "geometry_msgs/Twist") | .node'
    """
    from kg.facts import NodeKind  # noqa: PLC0415 - start-up time

    if kind is not None:
        require_one_of(kind, NodeKind, "kind", f"The kinds are {', '.join(NodeKind)}.")
    with reading(settings) as snapshot:
        if package:
            require_package(snapshot, package)
        if json:
            _objects(snapshot, package, kind)
        else:
            _table(snapshot, package, kind)


def _objects(snapshot: "EmbeddedSnapshot", package: str | None, kind: str | None) -> None:
    if package is None:
        for one in node_lines(snapshot):
            if kind in {None, one.kind}:
                write(one.text)
        return

    records = [one for one in node_records(snapshot, package=package) if kind in {None, one.node.kind}]
    listing(COLUMNS, (), objects=map(node_object, records))


def _table(snapshot: "EmbeddedSnapshot", package: str | None, kind: str | None) -> None:
    every = node_summaries(snapshot) if package is None else overview.nodes(snapshot, package)
    listed = [one for one in every if kind in {None, one.kind}]
    rows = []
    for one in listed:
        ends = (one.publishes, one.subscribes, one.services, one.clients, one.actions)
        rows.append((one.package, one.name, str(one.kind), one.ros, *ends, one.parameters, str(one.location)))
    listing(COLUMNS, rows)
    if terminal():
        note(f"{count(len(listed), 'node')}; `kg node NAME` shows one")
