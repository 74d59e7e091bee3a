"""What small updates of a large store cost, beside a full run of the rules: `python benchmarks/updates STORE`.

The store is copied (hard links) into a temporary folder beside it first. Times are seconds of wall time and, in
brackets, of processor time of this process. README.md says what is measured.
"""

from __future__ import annotations

import argparse
import asyncio
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

from kg.pipeline.inferring import run_on_store
from kg.pipeline.updating.applying import Applier
from kg.pipeline.updating.changes import Update
from kg.pipeline.updating.writer import Writer
from kg.settings import load
from kg.store.backups import back_up
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout
from kg.store.opening import layout_of

_UPDATES: Final = 9
_PREFIX: Final = "PREFIX ros: <http://data.mksmart.org/onto-ros/class#> PREFIX rnkg: <https://w3id.org/rnkg/ns#> "


def _insertion(number: int) -> str:
    """Return an update that adds a node that publishes, from which rules infer."""
    node, end = f"<urn:bench:node:{number}>", f"<urn:bench:end:{number}>"
    triples = f"{node} a ros:Node ; ros:hasComponent {end} . {end} a ros:Publisher ; rnkg:connectsTo <urn:bench:topic>"
    return f"{_PREFIX} INSERT DATA {{ GRAPH <urn:bench:graph> {{ {triples} }} }}"


_DELETION: Final = f"{_PREFIX} DELETE WHERE {{ GRAPH <urn:bench:graph> {{ <urn:bench:node:1> ?p ?o }} }}"


class _Clock:
    """Wall and processor time since it was made."""

    def __init__(self) -> None:
        self._wall, self._processor = time.perf_counter(), time.process_time()

    def __str__(self) -> str:
        return f"{self.wall:.2f} ({time.process_time() - self._processor:.2f})"

    @property
    def wall(self) -> float:
        """Seconds."""
        return time.perf_counter() - self._wall


def main() -> None:
    """Measure the store that is named."""
    parser = argparse.ArgumentParser(prog="updates", description=main.__doc__)
    parser.add_argument("store", help="the store that is copied")
    original = layout_of(load({"store": parser.parse_args().store}))
    with tempfile.TemporaryDirectory(dir=original.root.parent) as folder:
        root = Path(folder) / ".kg"
        clock = _Clock()
        made = back_up(original, root)
        print(f"backup of {made.quads} quads: {clock}")
        if (original.cache / "columns").is_dir():
            shutil.copytree(original.cache / "columns", root / "cache" / "columns")
        settings = load({"store": str(root)})
        clock = _Clock()
        report = run_on_store(settings, full=True)
        print(f"full run of the rules, {report.inferred} inferred: {clock}")
        _one_by_one(EmbeddedStore(Layout(root)))
        asyncio.run(_by_a_process(Layout(root)))
        _from_the_shell(root)


def _one_by_one(store: EmbeddedStore) -> None:
    """Make updates in this process."""
    settings = load({"store": str(store.layout.root)})
    applier = Applier(store, settings)
    clock = _Clock()
    applier.warm()
    print(f"loading rules and what they know: {clock}")
    for number in range(_UPDATES):
        clock = _Clock()
        done = applier.apply(Update(text=_insertion(number)))
        print(f"insertion of 4 triples, {done.inferred_added} inferred, {done.mode}: {clock}")
    clock = _Clock()
    done = applier.apply(Update(text=_DELETION))
    print(f"deletion of {done.removed} triples, {done.inferred_removed} inferred, {done.mode}: {clock}")
    clock = _Clock()
    applier.save()
    print(f"saving what rules know: {clock}")


async def _by_a_process(layout: Layout) -> None:
    """Make updates as the server has them made."""
    async with Writer(layout, load({"store": str(layout.root)})) as writer:
        await writer.update(_insertion(100))
        walls = []
        for number in range(_UPDATES):
            clock = _Clock()
            await writer.update(_insertion(101 + number))
            walls.append(clock.wall)
    print(
        f"insertions by the process of a server, wall time: median {statistics.median(walls):.2f}, max {max(walls):.2f}"
    )


def _from_the_shell(root: Path) -> None:
    """Make updates by commands of their own, beside what no such command can do without."""
    told = [_command("kg", "update", "--store", str(root), _insertion(200 + number)) for number in range(_UPDATES)]
    least = [_command("python", "-c", "import numpy, pyoxigraph") for _ in range(_UPDATES)]
    figures = (min(told), statistics.median(told), min(least), statistics.median(least))
    print(
        "`kg update` of 4 triples, processor time: least {:.2f}, median {:.2f}; only loading numpy and pyoxigraph: "
        "{:.2f}, {:.2f}".format(*figures)
    )


def _command(*words: str) -> float:
    """Run a command of this environment and return its processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [str(Path(sys.executable).parent / words[0]), *words[1:]]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    main()
