"""`kg stats`: the figures of the graph."""

from typing import TYPE_CHECKING

import typer

from kg.cli.diagnostics import note
from kg.cli.options import Json, Store
from kg.cli.output import Column, json_lines, make_table, show, terminal, write
from kg.cli.session import session
from kg.render.text import count
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.query.stats import Statistics

__all__ = ["stats"]


def stats(context: typer.Context, *, json: Json = False, store: Store = None) -> None:
    """Count entities and triples by kind, entities per node, neighbours of entities and the paths between them.

    Two entities are neighbours when any property relates them; a path counts relations. In large graphs paths are
    followed from a sample of the entities.
    """
    from dataclasses import asdict  # noqa: PLC0415 - start-up time

    from kg.query.stats import statistics  # noqa: PLC0415 - start-up time

    with reading(session(context).settings(store=store)) as snapshot:
        found = statistics(snapshot)
    if json:
        pairs = ("entities", "triples", "per_node", "degree_by_kind")
        json_lines([{**asdict(found), **{name: dict(getattr(found, name)) for name in pairs}}])
    elif terminal():
        _tables(found)
    else:
        for section, rows in _sections(found):
            for name, figure in rows:
                write(f"{section}\t{name}\t{figure}")


def _sections(found: "Statistics") -> list[tuple[str, list[tuple[str, object]]]]:
    connected = found.connectivity
    return [
        ("entities", [*found.entities, ("all", connected.entities)]),
        ("triples", [*found.triples, ("quads in the store", found.quads)]),
        ("entities per node", [(name, f"{figure:.2f}") for name, figure in found.per_node]),
        ("neighbours", [(name, f"{figure:.2f}") for name, figure in found.degree_by_kind]),
        (
            "graph",
            [
                ("relations between entities", connected.relations),
                ("neighbours, mean", f"{connected.degree:.2f}"),
                ("neighbours, most", connected.highest),
                ("entities without any", connected.isolated),
                ("connected parts", connected.parts),
                ("entities in the largest part", connected.largest),
                ("shortest path, mean", f"{connected.path:.2f}"),
                ("shortest path, longest", connected.longest),
            ],
        ),
    ]


def _tables(found: "Statistics") -> None:
    from rich.columns import Columns  # noqa: PLC0415 - start-up time

    tables = [
        make_table((Column(section, "name"), Column("", "number")), rows) for section, rows in _sections(found) if rows
    ]
    show(Columns(tables, padding=(1, 4)))
    connected = found.connectivity
    if not connected.exact:
        note(f"paths were followed from {count(connected.sources, 'entity', 'entities')} of {connected.entities:,}")
