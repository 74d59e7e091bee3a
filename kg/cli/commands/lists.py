"""`kg nodes`, `packages`, `files`, `topics`, `services` and `actions`: lists over the whole store."""

from collections import Counter
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
from kg.views.lists import LISTS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.graph.reading.overview import Channel
    from kg.store.snapshot import EmbeddedSnapshot
    from kg.views import lists


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
    _table("packages", listed, objects=map(asdict, listed) if json else None)
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
        listed = channels(snapshot, kind, implicit=every)
    _table(f"{kind}s", listed, objects=(_channel_object(kind, one) for one in listed) if json else None)
    if terminal() and not json:
        note(count(len(listed), kind))


def _channel_object(kind: str, channel: "Channel") -> dict[str, object]:
    givers, takers = ("published_by", "subscribed_by") if kind == "topic" else ("offered_by", "called_by")
    return {
        kind: channel.name,
        "types": channel.types,
        givers: channel.givers,
        takers: channel.takers,
        "systems": channel.systems,
    }


def channel_rows(kind: str, listed: "Iterable[Mapping[str, Any]]") -> None:
    """Write topics, services or actions as a table, from the fields of `kg.graph.reading.overview.Channel`."""
    _table(f"{kind}s", [overview.Channel(**one) for one in listed])


def _table(of: str, listed: "Sequence[object]", *, objects: "Iterable[Any] | None" = None) -> None:
    """Write the list `of`; what is listed has the keys of its columns as attributes."""
    keys = [one.key for one in LISTS[of].in_commands]
    most = 2 if terminal() else _UNBOUNDED  # of several values in a cell
    rows = [[_cell(getattr(one, key), most) for key in keys] for one in listed] if objects is None else ()
    listing(table_columns(of), rows, objects=objects)


def table_columns(of: str) -> list[Column]:
    """Return the columns of a list of `kg.views.lists` as commands show them."""
    return [
        Column(one.head or one.title.lower(), _kind(one, LISTS[of].columns[0]), one.spare)
        for one in LISTS[of].in_commands
    ]


def _kind(column: "lists.Column", name: "lists.Column") -> str:
    if column.key == name.key:
        return "name"
    if column.shape == "number":
        return "number"
    return "dim" if column.spare and column.shape != "tags" else "text"


def _cell(value: object, most: int) -> object:
    return some(value, most) if isinstance(value, list | tuple) else value


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
            _summaries(snapshot, package, kind)


def _objects(snapshot: "EmbeddedSnapshot", package: str | None, kind: str | None) -> None:
    if package is None:
        for one in node_lines(snapshot):
            if kind in {None, one.kind}:
                write(one.text)
        return

    records = [one for one in node_records(snapshot, package=package) if kind in {None, one.node.kind}]
    _table("nodes", (), objects=map(node_object, records))


def _summaries(snapshot: "EmbeddedSnapshot", package: str | None, kind: str | None) -> None:
    every = node_summaries(snapshot) if package is None else overview.nodes(snapshot, package)
    listed = [one for one in every if kind in {None, one.kind}]
    _table("nodes", listed)
    if terminal():
        note(f"{count(len(listed), 'node')}; `kg node NAME` shows one")
