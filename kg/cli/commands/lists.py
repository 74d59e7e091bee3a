"""`kg packages`, `kg topics`, `kg services`, `kg actions`: lists over the whole store."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.diagnostics import note
from kg.cli.options import Json, Store
from kg.cli.output import Column, listing, terminal
from kg.cli.session import session
from kg.render.text import count
from kg.store.opening import reading

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

__all__ = ["actions", "channel_rows", "packages", "services", "topics"]

All = Annotated[
    bool, typer.Option("--all", "-a", help="Include what frameworks create implicitly (/rosout, /tf, ...).")
]


def packages(context: typer.Context, *, json: Json = False, store: Store = None) -> None:
    """List the packages with their nodes, interfaces and problems.

    Counts the nodes, interface definitions and problems of each package.
    """
    from kg.graph import overview  # noqa: PLC0415 - start-up time

    with reading(session(context).settings(store=store)) as snapshot:
        found = overview.packages(snapshot)
    columns = (
        Column("package", "name"),
        Column("version"),
        *(Column(title, "number") for title in ("ros", "nodes", "definitions", "problems")),
        Column("source", "dim", spare=1),
        Column("folder", "dim", spare=1),
    )
    rows = [
        (one.name, one.version, one.ros, one.nodes, one.definitions, one.problems, one.repository, one.folder)
        for one in found
    ]
    listing(columns, rows, objects=map(asdict, found) if json else None)
    if terminal() and not json:
        note(count(len(found), "package"))


def topics(context: typer.Context, *, every: All = False, json: Json = False, store: Store = None) -> None:
    """List the topics with their types and numbers of nodes.

    Names are those in launched systems, after remapping, and those of nodes started alone. `kg topic NAME` shows one.
    """
    _list(context, "topic", store, every=every, json=json)


def services(context: typer.Context, *, every: All = False, json: Json = False, store: Store = None) -> None:
    """List the services with their types and numbers of nodes.

    `kg service NAME` shows one.
    """
    _list(context, "service", store, every=every, json=json)


def actions(context: typer.Context, *, every: All = False, json: Json = False, store: Store = None) -> None:
    """List the actions with their types and numbers of nodes.

    `kg action NAME` shows one.
    """
    _list(context, "action", store, every=every, json=json)


def _list(context: typer.Context, kind: str, store: str | None, *, every: bool, json: bool) -> None:
    from kg.views.answers import channels  # noqa: PLC0415 - start-up time

    settings = session(context).settings(store=store)
    with reading(settings) as snapshot:
        found = [asdict(one) for one in channels(snapshot, kind, implicit=every)]
    channel_rows(kind, found, json=json)
    if terminal() and not json:
        note(count(len(found), kind))


def channel_rows(kind: str, found: "Sequence[Mapping[str, Any]]", *, json: bool = False) -> None:
    """Write topics, services or actions as a list: objects as of `kg.graph.overview.Channel`."""
    verbs = ("publish", "subscribe") if kind == "topic" else ("offer", "call")
    columns = (
        Column(kind, "name"),
        Column("type", spare=1),
        *(Column(verb, "number") for verb in verbs),
        Column("launch files", "number"),
    )
    rows = [
        (one["name"], ", ".join(one["types"]), len(one["givers"]), len(one["takers"]), one["systems"]) for one in found
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
        for one in found
    )
    listing(columns, rows, objects=objects if json else None)
