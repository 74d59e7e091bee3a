"""A store with findings, made from `findings.trig` and the launch files in `cases/rover/`."""

from __future__ import annotations

import shutil
from collections import defaultdict
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import NamedNode, RdfFormat, parse

from kg.facts import Repository
from kg.graph.builds import BuildRecord, build_triples, count
from kg.graph.iris import Iris
from kg.lint.finding import Evidence, Finding
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["HERE", "finding", "read", "write"]

HERE: Final = Path(__file__).parent
NOON: Final = datetime(2026, 5, 1, 12, tzinfo=UTC)


def write(folder: Path) -> Path:
    """Copy the sources to `folder/rover` and write their store next to them; return the store's folder."""
    root = folder / "rover"
    shutil.copytree(HERE / "cases" / "rover", root)
    graphs: defaultdict[NamedNode, list[bytes]] = defaultdict(list)
    for quad in parse((HERE / "findings.trig").read_bytes(), RdfFormat.TRIG):
        if isinstance(quad.graph_name, NamedNode):
            graphs[quad.graph_name].append(f"{quad.triple} .\n".encode())
    iris = Iris()
    record = BuildRecord(Repository("local/rover", str(root)), NOON, NOON, "0.1.0", count([]))
    store = folder / ".kg"
    with EmbeddedStore.create(store).write("test") as transaction:
        transaction.replace_graphs(graphs)
        transaction.append(NamedNode(iris.graph("builds")), build_triples(record, iris))
    return store


def read(folder: Path) -> EmbeddedSnapshot:
    """Return the content of the store in a folder."""
    return EmbeddedStore.find(folder).read()


def finding(**more: Any) -> Finding:
    """Return a new finding with some fields changed."""
    known: dict[str, Any] = {
        "code": "KG407",
        "rule": "architecture/remap-to-unused",
        "severity": "warning",
        "system": "bringup/launch/base.launch",
        "message": "nothing else uses /a",
        "subjects": ("/a",),
        "place": Evidence("bringup/launch/base.launch", 3, "local/rover"),
    }
    return Finding(**(known | more))
