"""How long all launch files of a workspace take: reading, wiring, writing, and one of them from the command line.

    python benchmarks/launch FOLDER ... [--store FOLDER]

The folders are built into a store first (`--store` keeps it), which is not measured. Then every launch file is
evaluated with what it includes, in one process; wired with the node types of the store; and written as triples.
Seconds are of processor time, with those of parsing the same files as XML or Python, without evaluating anything,
beside them. A second table tells how many quads the store has, in which graphs, and the bytes of its folder.
"""

from __future__ import annotations

import argparse
import ast
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

from kg.api import build
from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace
from kg.graph.iris import Iris
from kg.graph.systems import system_triples
from kg.launch.files import read_launches
from kg.launch.wiring.systems import wire
from kg.pipeline.report import Report
from kg.pipeline.sources import gather
from kg.pipeline.systems import node_types, used_packages
from kg.settings import load
from kg.store.opening import existing

if TYPE_CHECKING:
    from kg.corpus.files import PackageFolder, Source
    from kg.facts import LaunchConfiguration, System


def main() -> int:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", metavar="FOLDER")
    parser.add_argument("--store", help="keep the store here, or take one that was kept")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kg-launch-") as scratch:
        store = given.store or f"{scratch}/store"
        if not Path(store).exists():
            build(given.folders, store=store)
        workspace = Workspace(gather(given.folders, Path(scratch), Report()))
        packages = [(source, package) for source in workspace.sources for package in source.packages]
        began = time.process_time()
        configurations = [one for source, package in packages for one in _read(workspace, source, package)]
        read = time.process_time()
        systems, written = _wired(store, configurations)
        ended = time.process_time()
        parsed = _parse(workspace, configurations)
        counts, size = _stored(store)
    nodes = sum(len(one.instances) for one in systems)
    print("| launch files | instances | triples | evaluate | wire and write | all | of that parsing alone |")
    print("|---|---|---|---|---|---|---|")
    print(
        f"| {len(configurations):,} | {nodes:,} | {written:,} | {read - began:.2f} s | {ended - read:.2f} s "
        f"| {ended - began:.2f} s | {parsed:.2f} s |"
    )
    print()
    print("| quads | of launch files | for each instance | of what they are started with | inferred | megabytes |")
    print("|---|---|---|---|---|---|")
    print(
        f"| {counts.total():,} | {counts['launch']:,} | {counts['launch'] / max(nodes, 1):.1f} | {counts['starts']:,} "
        f"| {counts['inferred']:,} | {size / 1e6:.0f} |"
    )
    return 0


def _stored(store: str) -> tuple[Counter[str], int]:
    """Return how many quads the graphs of each kind have, and how many bytes the files of a store."""
    settings = load({"store": store})
    counts: Counter[str] = Counter()
    with existing(settings).read() as snapshot:
        for graph in snapshot.graphs():
            kind = graph.value.removeprefix(f"{settings.base}graph/").partition("/")[0]
            counts[kind] += snapshot.count(graph)
    return counts, sum(path.stat().st_size for path in Path(store).rglob("*") if path.is_file())


def _read(workspace: Workspace, source: Source, package: PackageFolder) -> tuple[LaunchConfiguration, ...]:
    manifest = (source.root / package.manifest).read_text(errors="replace") if package.manifest else ""
    return read_launches(Reader(workspace, source, package), package, 2 if "ament" in manifest else 1)


def _wired(store: str, configurations: list[LaunchConfiguration]) -> tuple[list[System], int]:
    """Return the systems, and how many triples they make."""
    settings = load({"store": store})
    iris = Iris(settings.base)
    with existing(settings).read() as snapshot:
        types, records = node_types(snapshot, used_packages(configurations))
    systems = [wire(one, types) for one in configurations]
    return systems, sum(system_triples(one, records, iris).count(b"\n") for one in systems)


def _parse(workspace: Workspace, configurations: list[LaunchConfiguration]) -> float:
    """Return the processor time of parsing each launch file once."""
    texts = []
    for one in configurations:
        source = workspace.source(one.repository)
        if source is not None:
            texts.append((one.path, (source.root / one.path).read_bytes()))
    began = time.process_time()
    for path, text in texts:
        with suppress(etree.XMLSyntaxError, SyntaxError, ValueError):
            if path.endswith(".py"):
                ast.parse(text)
            else:
                etree.fromstring(text)
    return time.process_time() - began


if __name__ == "__main__":
    sys.exit(main())
