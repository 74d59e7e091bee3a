"""Compares computation graphs that were observed on running systems with what `kg` resolves from their sources.

    python benchmarks/observed --mirrors MIRRORS [--workspaces FOLDER] [--only SYSTEM ...] [--misses]

MIRRORS has a git directory for each repository of `*.json` (`owner+name`, `owner/name`, bare or not). The repositories
become one workspace with a launch file that starts the whole system; `kg build` reads it, `kg instances --launch` says
what it starts. Rows for each system: precision and recall over (node, role, name), for nodes that have source there,
for those of them that had started when they were observed, and for those whose code the peer read.
`--misses` lists what was missed and what was too much. `--unpack` only makes the workspaces.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from bugs.commands import answers, build
from bugs.workspaces import MissingError, Plan, environment, make
from observed.comparing import Comparison, compare

GRAPHS = sorted(Path(__file__).parent.glob("*.json"))
HEAD = ("system", "nodes", "observed", "resolved", "precision", "recall", "names unresolved")


def main() -> None:
    """Make the workspaces, ask for their instances, print the table."""
    options = _options()
    graphs = [json.loads(path.read_text(encoding="utf-8")) for path in GRAPHS]
    graphs = [graph for graph in graphs if not options.only or graph["system"] in options.only]
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.workspaces or Path(scratch)
        if options.unpack:
            for graph in graphs:
                print(graph["system"], _workspace(graph, options.mirrors, folder))
            return
        compared = [pair for graph in graphs for pair in _run(graph, options.mirrors, folder)]
    _print(compared, misses=options.misses)


def _run(graph: dict[str, Any], mirrors: Path, folder: Path) -> list[tuple[str, Comparison]]:
    system = graph["system"]
    try:
        launch = _workspace(graph, mirrors, folder)
    except MissingError as missing:
        print(f"{system}: {missing}", file=sys.stderr)
        return []
    store = folder / f"{system}.kg"
    build(folder / system, store)
    instances = answers("instances", launch, store, environment(graph["environment"]))
    with_source = [node for node in graph["nodes"] if node["source"]]
    from_code = [node for node in with_source if node["peer"] == "code"]
    started = [node for node in with_source if not node.get("partial")]
    return [
        (f"{system}, nodes with source", compare(with_source, instances)),
        (f"{system}, nodes with source that had started", compare(started, instances)),
        (f"{system}, nodes whose code the peer read", compare(from_code, instances)),
    ]


def _workspace(graph: dict[str, Any], mirrors: Path, folder: Path) -> Path:
    trees = [(one["repository"], one["repository"].split("/")[1], one["commit"]) for one in graph["repositories"]]
    starts = [(one["file"], one.get("arguments", {})) for one in graph["launch"]]
    return make(Plan(trees, starts), mirrors, folder / graph["system"])


def _print(compared: list[tuple[str, Comparison]], *, misses: bool) -> None:
    print(f"| {' | '.join(HEAD)} |\n|{'---|' * len(HEAD)}")
    for label, one in compared + _totals(compared):
        print(f"| {label} | {' | '.join(one.cells())} |")
    if misses:
        for label, one in compared:
            for sign, items in (("-", one.observed - one.resolved), ("+", one.resolved - one.observed)):
                for node, role, name in sorted(items):
                    print(f"{label}: {sign} {node} {role} {name}")


def _totals(compared: list[tuple[str, Comparison]]) -> list[tuple[str, Comparison]]:
    groups: dict[str, Comparison] = {}
    for label, one in compared:
        system, _, group = label.partition(", ")
        groups[group] = groups.get(group, Comparison()).with_system(system, one)
    return [(f"all, {group}", total) for group, total in groups.items()]


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mirrors", type=Path, required=True, help="folder with the git directories")
    parser.add_argument(
        "--workspaces", type=Path, help="where to make the workspaces; by default a folder that is removed"
    )
    parser.add_argument("--only", nargs="+", default=[], metavar="SYSTEM", help="only these systems")
    parser.add_argument("--misses", action="store_true", help="list what was missed (-) and what was too much (+)")
    parser.add_argument("--unpack", action="store_true", help="only make the workspaces")
    return parser.parse_args()


if __name__ == "__main__":
    main()
