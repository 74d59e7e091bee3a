"""Answers needs of developers by a store, writes the ranked nodes for a scorer, and measures what that takes.

    python benchmarks/search --store FOLDER --queries QUERIES.jsonl --ranked RANKED.jsonl [--limit 10] [--half odd|even]
    python benchmarks/search --store FOLDER --needs benchmarks/search/needs.jsonl
    python benchmarks/search --store FOLDER --judge QUERIES.jsonl... [--fit]
    python benchmarks/search --store FOLDER --times [--nodes 10000]

The first writes one object a query: {"id": ..., "nodes": [{"repository", "package", "node"}, ...]}, in rank order; each
query has an `id` and a `query`. A half takes every second query, so that weights can be tried on one and checked on
the other. The second prints for how many needs a node that does (`package/node`) comes first, or among five. The third
prints NDCG of the search and of plain BM25; `--fit` also chooses weights inside five folds and scores the needs that
were held out. The last times in CPU seconds: reading the store, building the index (repeated until it has so many
nodes), reading it back, and a query of a warm process.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import msgspec
from judging import judge

from kg import settings
from kg.search import cache
from kg.search.index import build
from kg.search.reading import Content, read
from kg.search.searching import Search, hit_object, open_search
from kg.store import opening

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.search.documents import Document, PackageDocument
    from kg.search.searching import Hit

T = TypeVar("T")
NEEDS = (
    "merge the scans of two lasers into one",
    "detect people with a camera and follow them",
    "subscribes PointCloud2 and publishes LaserScan",
    "driver for a joystick for ROS 2",
    "turn GPS fixes into odometry in the local frame",
    "stop before obstacles that a depth camera sees, BSD licensed",
)
REPEAT = 20
FIVE, TEN = 5, 10


def main() -> None:
    """Read the command line, search or measure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--store", required=True, help="the store to search in")
    parser.add_argument("--queries", type=Path, help="JSON Lines with `id` and `query`")
    parser.add_argument("--ranked", type=Path, help="where to write the ranked nodes")
    parser.add_argument("--limit", type=int, default=10, help="how many nodes a query gets")
    parser.add_argument("--half", choices=("even", "odd"), help="only the queries at even or odd places")
    parser.add_argument("--needs", type=Path, help="JSON Lines with `query` and the `nodes` that do")
    parser.add_argument("--judge", type=Path, nargs="+", help="JSON Lines with `query` and graded `relevant` nodes")
    parser.add_argument("--fit", action="store_true", help="cross-validate the weights")
    parser.add_argument("--times", action="store_true", help="measure")
    parser.add_argument("--nodes", type=int, default=10000, help="how many nodes the measured index has")
    options = parser.parse_args()
    if options.times:
        measure(options.store, options.nodes)
    elif options.judge:
        store = opening.existing(settings.load({"store": options.store}))
        judge(open_search(store), options.judge, fit=options.fit)
    elif options.needs:
        check(options.store, options.needs)
    else:
        rank(options)


def rank(options: argparse.Namespace) -> None:
    """Write the ranked nodes of each query."""
    search = open_search(opening.existing(settings.load({"store": options.store})))
    queries = [json.loads(line) for line in options.queries.read_text("utf-8").splitlines()]
    chosen = queries if options.half is None else queries[options.half == "odd" :: 2]
    with options.ranked.open("w", encoding="utf-8") as file:
        for query in chosen:
            hits = map(hit_object, search.find(query["query"], limit=options.limit).hits)
            nodes = [{key: hit[key] for key in ("repository", "package", "node")} for hit in hits]
            file.write(json.dumps({"id": query["id"], "nodes": nodes}) + "\n")


def check(store: str, needs: Path) -> None:
    """Print for how many needs the first node, or one of the first five, is one that does."""
    search = open_search(opening.existing(settings.load({"store": store})))
    ranks = []
    for need in map(json.loads, needs.read_text("utf-8").splitlines()):
        hits = search.find(need["query"], limit=TEN).hits
        names = [{hit.package.name + "/" + name for name in _names(hit)} for hit in hits]
        ranks.append(next((rank for rank, found in enumerate(names, 1) if found & set(need["nodes"])), None))
    found = [rank for rank in ranks if rank]
    print(f"{len(ranks)} needs: first {found.count(1)}, among five {sum(rank <= FIVE for rank in found)}")
    print(f"mean reciprocal rank {sum(1 / rank for rank in found) / len(ranks):.3f}")


def _names(hit: Hit) -> set[str]:
    """Return the names of a hit and of the variants that it stands for."""
    return {hit.name, hit.node.name, *(node.name for package, node in hit.others if package.name == hit.package.name)}


def measure(store: str, size: int) -> None:
    """Print what reading, building and searching take, in CPU seconds."""
    with opening.reading(settings.load({"store": store})) as snapshot:
        content, reading = timed(lambda: read(snapshot))
    index, building = timed(lambda: build(_grown(content, size)))
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        cache.save(Path(folder), "1", index)
        file = next(Path(folder).rglob("1"))
        megabytes = file.stat().st_size / 1e6
        loaded, loading = timed(lambda: cache.load(Path(folder), "1"))
    if loaded is None:
        raise SystemExit("the index that was written cannot be read")
    search = Search(loaded)
    search.find(NEEDS[0])
    _, searching = timed(lambda: [search.find(need) for _ in range(REPEAT) for need in NEEDS])
    print(f"reading {len(content.nodes)} nodes of the store: {reading:.2f} s")
    print(f"indexing {index.size} nodes: {building:.2f} s, {megabytes:.1f} MB")
    print(f"reading the index back: {loading * 1e3:.0f} ms")
    print(f"a query: {searching / REPEAT / len(NEEDS) * 1e3:.1f} ms")


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """Return what some work gives, and its CPU time in seconds."""
    began = time.process_time()
    return work(), time.process_time() - began


def _grown(content: Content, size: int) -> Content:
    """Return the content with copies of its packages, under other names, until it has so many nodes."""
    packages: list[PackageDocument] = []
    nodes: list[Document] = []
    copy = 0
    while len(nodes) < size:
        first = len(packages)
        packages += [
            msgspec.structs.replace(one, iri=f"{one.iri}-{copy}", name=f"{one.name}_{copy}") for one in content.packages
        ]
        nodes += [
            msgspec.structs.replace(one, package=one.package + first)
            for one in content.nodes[: max(0, size - len(nodes))]
        ]
        copy += 1
    return Content(packages, nodes, content.concepts)


if __name__ == "__main__":
    main()
