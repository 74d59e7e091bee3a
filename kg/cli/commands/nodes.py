"""`kg nodes`: every node type of the store."""

from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.diagnostics import note
from kg.cli.names import known_package
from kg.cli.options import Json, PackageName, Store
from kg.cli.output import Column, listing, terminal
from kg.cli.session import session
from kg.errors import UsageError
from kg.render.text import count
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.graph.reading import NodeRecord

__all__ = ["nodes"]

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


def nodes(
    context: typer.Context, *, package: PackageName = None, kind: Kind = None, json: Json = False, store: Store = None
) -> None:
    """List every node with how many interfaces it has.

    The columns count what the code declares itself: topics published (pub) and subscribed (sub), services
    offered (srv) and called (cli), actions offered or called (act), parameters (par). For example:

        kg nodes --package move_base
        kg nodes --json | jq -r 'select(.publishes[].type == "geometry_msgs/Twist") | .node'
    """
    from kg.facts import NodeKind  # noqa: PLC0415 - start-up time
    from kg.graph.reading import node_records  # noqa: PLC0415 - start-up time
    from kg.graph.records import node_object  # noqa: PLC0415 - start-up time

    if kind is not None and kind not in set(NodeKind):
        raise UsageError("KG003", f"there is no kind `{kind}`", hint=f"The kinds are {', '.join(NodeKind)}.")
    with reading(session(context).settings(store=store)) as snapshot:
        if package:
            known_package(snapshot, package)
        records = [one for one in node_records(snapshot, package=package) if kind in {None, one.node.kind}]
    listing(COLUMNS, [_row(one) for one in records], objects=map(node_object, records) if json else None)
    if terminal() and not json:
        note(f"{count(len(records), 'node')}; `kg node NAME` shows one")


def _row(record: "NodeRecord") -> tuple[object, ...]:
    from kg.facts import Role  # noqa: PLC0415 - start-up time

    node = record.node
    roles = [one.role for one in node.interfaces if not one.implicit]
    actions = roles.count(Role.ACTION_SERVERS) + roles.count(Role.ACTION_CLIENTS)
    counts = (roles.count(role) for role in (Role.PUBLISHES, Role.SUBSCRIBES, Role.SERVICES, Role.CLIENTS))
    parameters = len({one.name for one in node.parameters if not one.implicit})
    return record.package, node.name, str(node.kind), node.ros, *counts, actions, parameters, str(node.location)
