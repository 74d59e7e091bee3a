"""Answers about the whole store, kept in its cache: a generation never changes, so neither do its figures and lists.

    .kg/cache/answers/stats/12      the answer `stats` about generation 12

An answer counts as missing when the code or the queries that computed it have changed. It is then computed again.
"""

from __future__ import annotations

import gc
import zlib
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import msgspec

from kg import resources
from kg.lazily import lazily
from kg.pipeline.filecache import are_stable, states
from kg.render.text import json_text
from kg.store.cachefile import load, save

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from kg.graph.reading import impact_parts, overview
    from kg.graph.reading.channels import every_name
    from kg.graph.reading.nodes import node_records
    from kg.graph.records import node_object
    from kg.query import stats
    from kg.rules.selecting import columns_of

_FOLDER: Final = "answers"
_CODE: Final = ("facts", "graph", "launch/wiring", "query", "render", "views")
"""The folders of the code that computes answers."""

_Answer = TypeVar("_Answer")


@dataclass(frozen=True, slots=True)
class Figures:
    """What `kg stats` shows: the figures of the graph, and those that RNKG counts."""

    graph: stats.Statistics
    rnkg: stats.Counted


@dataclass(frozen=True, slots=True)
class NodeLine:
    """A node type as a line of JSON, without the end of the line, with its kind and its IRI."""

    kind: str
    iri: str
    text: str


def figures(snapshot: EmbeddedSnapshot) -> Figures:
    """Return the figures of the store whose content `snapshot` is."""

    def make() -> Figures:
        graph = columns_of(snapshot)
        return Figures(stats.statistics(graph), stats.counted(graph))

    return _answer(snapshot, "stats", Figures, make)


def channels(snapshot: EmbeddedSnapshot, kind: str, *, implicit: bool = False) -> list[overview.Channel]:
    """Return the topics, services or actions of the store, as `kg.graph.reading.overview.channels` does."""
    name = f"{kind}-all" if implicit else kind
    return _answer(
        snapshot, name, list[overview.Channel], lambda: overview.channels(columns_of(snapshot), kind, implicit=implicit)
    )


def node_lines(snapshot: EmbeddedSnapshot) -> list[NodeLine]:
    """Return all node types of the store as lines of JSON, in the order of `kg.graph.reading.nodes.node_records`."""

    def make() -> list[NodeLine]:
        return [
            NodeLine(str(one.node.kind), one.iri, json_text(node_object(one)))
            for one in node_records(columns_of(snapshot))
        ]

    return _answer(snapshot, "nodes", list[NodeLine], make)


def node_summaries(snapshot: EmbeddedSnapshot) -> list[overview.NodeSummary]:
    """Return all node types with the numbers of their interfaces, as `kg.graph.reading.overview.nodes` does."""
    return _answer(snapshot, "summaries", list[overview.NodeSummary], lambda: overview.nodes(columns_of(snapshot)))


def channel_names(snapshot: EmbeddedSnapshot) -> dict[str, list[str]]:
    """Return all names of topics, services and actions, as `kg.graph.reading.channels.every_name` does."""
    return _answer(snapshot, "names", dict[str, list[str]], lambda: every_name(columns_of(snapshot)))


def partial_names(snapshot: EmbeddedSnapshot) -> list[str]:
    """Return the names of ends with unknown parts, as `kg.graph.reading.impact_parts.partial_names` does."""
    return _answer(snapshot, "partly-known", list[str], lambda: impact_parts.partial_names(columns_of(snapshot)))


def set_names(snapshot: EmbeddedSnapshot) -> list[str]:
    """Return the names of settings and of what they set, as `kg.graph.reading.impact_parts.set_names` does."""
    return _answer(snapshot, "set-names", list[str], lambda: impact_parts.set_names(columns_of(snapshot)))


def rows(snapshot: EmbeddedSnapshot, name: str, make: Callable[[], list[dict[str, Any]]]) -> list[dict[str, Any]]:
    """Return the rows of a list over the whole store; `make` computes those that are not kept under this name."""
    return _answer(snapshot, name, list[dict[str, Any]], make)


def totals(snapshot: EmbeddedSnapshot, make: Callable[[], dict[str, int]] | None = None) -> dict[str, int]:
    """Return how long lists over the whole store are; without `make` nothing where that is not kept."""
    kind = dict[str, int]
    return _answer(snapshot, "totals", kind, make) if make else _cached(snapshot, "totals", kind) or {}


def _answer(snapshot: EmbeddedSnapshot, name: str, kind: type[_Answer], make: Callable[[], _Answer]) -> _Answer:
    """Return a kept answer of a type, or compute it and keep it; where nothing can be written it is computed."""
    value = _cached(snapshot, name, kind)
    if value is None:
        # An answer has no garbage in cycles, which would be searched for again and again as it grows.
        enabled = gc.isenabled()
        gc.disable()
        try:
            value = make()
        finally:
            if enabled:
                gc.enable()
        version = _version()
        if version is not None and snapshot.layout is not None:
            with suppress(OSError):
                save(snapshot.layout.cache / _FOLDER / name, snapshot.identity, version, [msgspec.json.encode(value)])
    return value


def _cached(snapshot: EmbeddedSnapshot, name: str, kind: type[_Answer]) -> _Answer | None:
    version = _version()
    if version is None or snapshot.layout is None:
        return None
    body = load(snapshot.layout.cache / _FOLDER / name, snapshot.identity, version)
    return None if body is None else msgspec.json.decode(body, type=kind)


@cache
def _version() -> int | None:
    """Return a number for the files that answers are computed with; None while these change."""
    code = Path(__file__).resolve().parent.parent
    folders = (*(code / name for name in _CODE), resources.folder("queries"))
    seen = tuple(state for folder in folders for state in states(folder))
    return zlib.crc32(repr(seen).encode()) if are_stable(seen) else None
