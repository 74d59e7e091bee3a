"""`kg nodes`: every node type of the store."""

from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.diagnostics import note
from kg.cli.options import Json, PackageName, require_one_of, with_settings
from kg.cli.output import Column, listing, terminal, write
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import reading
from kg.views.names import require_package

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from kg.graph.reading import overview
    from kg.graph.reading.nodes import node_records
    from kg.graph.records import node_object
    from kg.views.answers import node_lines, node_summaries

COLUMNS: Final = (
    Column("package"),
    Column("node", "name"),
    Column("kind"),
    *(Column(title, "number") for title in ("ros", "pub", "sub", "srv", "cli", "act", "par")),
    Column("file:line", "dim", spare=1),
)
Kind = Annotated[
    str | None,
    typer.Option("--kind", metavar="KIND", help="Only executable, script, nodelet, component, plugin or class."),
]


@with_settings("store")
def nodes(
    *,
    settings: Settings,
    package: PackageName = None,
    kind: Kind = None,
    json: Json = False,
) -> None:
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
