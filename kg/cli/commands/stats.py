"""`kg stats`: the figures of the graph."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Final

from kg.cli.diagnostics import note
from kg.cli.options import Json, with_settings
from kg.cli.output import Column, json_lines, make_table, numbers, show, terminal, write
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import reading

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.query.stats import Counted, Statistics

with lazily():
    from rich.columns import Columns

    from kg.corpus.selection.select import paper_figures
    from kg.syntax.names import shorten
    from kg.views.answers import figures

_MOST: Final = 12
_RNKG_COLUMNS: Final = (Column("as RNKG counts", "name"), *numbers("here", "RNKG"))


@with_settings("store")
def stats(*, settings: Settings, json: Json = False) -> None:
    """Count entities, triples, neighbours and paths of the graph.

    Counts by kind: entities, triples, entities per node, neighbours. Two entities are neighbours if any property
    relates them. The length of a path is its number of relations. In large graphs, paths are followed from a sample of
    the entities. The figures of the RNKG paper are listed next to ours, counted the same way: repositories, packages,
    nodes, topics, services, messages, hardware, functions, and the relations between them.
    """
    with reading(settings) as snapshot:
        figured = figures(snapshot)
    counted, ours = figured.graph, figured.rnkg
    if json:
        pairs = ("entities", "triples", "per_node", "degree_by_kind")
        plain = {**asdict(counted), **{name: dict(getattr(counted, name)) for name in pairs}}
        here = asdict(ours) | {"by_kind": dict(ours.by_kind)}
        json_lines([{**plain, "rnkg": {"here": here, "paper": dict(paper_figures().graph)}}])
    elif terminal():
        _tables(counted, ours)
    else:
        for section, rows in _sections(counted):
            for name, figure in rows:
                write(f"{section}\t{name}\t{figure}")
        for row in _rnkg_rows(ours):
            write("\t".join(["as RNKG counts", *map(str, row)]))


def _sections(counted: "Statistics", most: int | None = None) -> list[tuple[str, list[tuple[str, object]]]]:
    """Return titled figures; with `most`, the triples of the rarer properties are counted together."""
    connected = counted.connectivity
    triples: list[tuple[str, object]] = [(shorten(iri).strip("<>"), number) for iri, number in counted.triples[:most]]
    others = counted.triples[len(triples) :]
    if others:
        triples.append((f"{len(others)} other properties", sum(number for _, number in others)))
    return [
        ("entities", [*counted.entities, ("all", sum(number for _, number in counted.entities))]),
        ("entities per node", [(name, f"{figure:.2f}") for name, figure in counted.per_node]),
        ("neighbours", [(name, f"{figure:.2f}") for name, figure in counted.degree_by_kind]),
        (
            "graph",
            [
                ("entities", connected.entities),
                ("relations between them", connected.relations),
                ("neighbours, mean", f"{connected.degree:.2f}"),
                ("neighbours, most", connected.highest),
                ("entities without any", connected.isolated),
                ("connected parts", connected.parts),
                ("entities in the largest part", connected.largest),
                ("shortest path, mean", f"{connected.path:.2f}"),
                ("shortest path, median", f"{connected.path_median:g}"),
                ("shortest path, longest", connected.longest),
            ],
        ),
        ("triples", [*triples, ("quads in the store", counted.quads)]),
    ]


def _tables(counted: "Statistics", ours: "Counted") -> None:
    tables = [
        make_table((Column(section, "name"), Column("", "number")), rows)
        for section, rows in _sections(counted, _MOST)
        if rows
    ]
    tables.append(make_table(_RNKG_COLUMNS, _rnkg_rows(ours)))
    show(Columns(tables, padding=(1, 4)))
    connected = counted.connectivity
    if not connected.exact:
        note(f"paths were followed from {count(connected.sources, 'entity', 'entities')} of {connected.entities:,}")


def _rnkg_rows(ours: "Counted") -> "Iterator[tuple[str, str, str]]":
    """Yield the figures of a graph as RNKG counts them, with those printed in the paper."""
    for name, theirs in paper_figures().graph.items():
        yield name.replace("_", " "), _plain(getattr(ours, name)), _plain(theirs)
    for kind, number in ours.by_kind:
        yield f"of these {kind}", _plain(number), "-"


def _plain(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:,}" if isinstance(value, int) else f"{value:,.2f}".removesuffix(".00")
