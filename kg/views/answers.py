"""Answers about the whole store, kept in its cache: a generation never changes, so neither do its figures and lists.

    .kg/cache/answers/stats/12      the answer `stats` about generation 12

An answer counts as missing when the code or the queries that computed it have changed. It is then computed again.
"""

from __future__ import annotations

import zlib
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeVar

import msgspec

from kg import resources
from kg.graph import overview
from kg.graph.overview import Channel
from kg.graph.reading import node_records
from kg.graph.records import node_object
from kg.pipeline.kept import settled, states
from kg.query.counting import Counted, counted
from kg.query.stats import Statistics, statistics
from kg.render.text import json_text
from kg.store.kept import keep, kept
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["Figures", "NodeLine", "channels", "figures", "node_lines"]

_FOLDER: Final = "answers"
_CODE: Final = ("facts", "graph", "launch/wiring", "query", "render", "views")
"""The folders of the code that computes answers."""

_Answer = TypeVar("_Answer")


@dataclass(frozen=True, slots=True)
class Figures:
    """What `kg stats` shows: the figures of the graph, and those that RNKG counts."""

    graph: Statistics
    rnkg: Counted


@dataclass(frozen=True, slots=True)
class NodeLine:
    """A node type as a line of JSON, without the end of the line, and its kind."""

    kind: str
    text: str


def figures(snapshot: EmbeddedSnapshot, settings: Settings) -> Figures:
    """Return the figures of the store in force, of which `snapshot` is the content."""
    return _answer(snapshot, settings, "stats", Figures, lambda: Figures(statistics(snapshot), counted(snapshot)))


def channels(snapshot: EmbeddedSnapshot, settings: Settings, kind: str, *, implicit: bool = False) -> list[Channel]:
    """Return the topics, services or actions of the store in force, as `kg.graph.overview.channels` does."""
    name = f"{kind}-all" if implicit else kind
    return _answer(
        snapshot, settings, name, list[Channel], lambda: overview.channels(snapshot, kind, implicit=implicit)
    )


def node_lines(snapshot: EmbeddedSnapshot, settings: Settings) -> list[NodeLine]:
    """Return all node types of the store in force as lines of JSON, in the order of `kg.graph.reading.node_records`."""

    def make() -> list[NodeLine]:
        return [NodeLine(str(one.node.kind), json_text(node_object(one))) for one in node_records(snapshot)]

    return _answer(snapshot, settings, "nodes", list[NodeLine], make)


def _answer(
    snapshot: EmbeddedSnapshot, settings: Settings, name: str, kind: type[_Answer], make: Callable[[], _Answer]
) -> _Answer:
    """Return a kept answer of a type, or compute it and keep it; where nothing can be written it is computed."""
    version = _version()
    if version is None:
        return make()
    folder = layout_of(settings).cache / _FOLDER / name
    body = kept(folder, snapshot.identity, version)
    if body is not None:
        return msgspec.json.decode(body, type=kind)
    found = make()
    with suppress(OSError):
        keep(folder, snapshot.identity, version, [msgspec.json.encode(found)])
    return found


@cache
def _version() -> int | None:
    """Return a number for the files that answers are computed with; None while these change."""
    code = Path(__file__).resolve().parent.parent
    folders = (*(code / name for name in _CODE), resources.folder("queries"))
    seen = tuple(state for folder in folders for state in states(folder))
    return zlib.crc32(repr(seen).encode()) if settled(seen) else None
