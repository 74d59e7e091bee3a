"""Prints the processor seconds of a whole cold build by part, and the peak of memory, as JSON.

    python benchmarks/build/parts.py CHECKOUT

Packages are read one after the other in the process that writes, so that each second is charged to one part. Seconds
are those of all threads. For what is below a part, run this under a profiler:

    py-spy record -f raw -o samples -- python benchmarks/build/parts.py CHECKOUT
"""

from __future__ import annotations

import gc
import json
import os
import resource
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as `kg` does

from clock import Clock, Stages

from kg import settings
from kg.extract import texts
from kg.language import annotating
from kg.pipeline import build, cache, pool, reasoning, systems, wiring, work, writing
from kg.rules.running import Reasoner, Runner
from kg.rules.written import Written
from kg.store.embedded import EmbeddedStore
from kg.store.transaction import EmbeddedTransaction

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Self

    from kg.pipeline.pool import Task
    from kg.pipeline.work import Job, Outcome

PARTS: Stages = {
    "extraction": [(work, "read_package")],
    "reading texts": [(texts, "read_descriptions")],
    "loading the language model": [(annotating, "prepare")],
    "tagging texts": [(work, "annotate")],
    "triples of packages": [(work, "package_parts"), (work, "split"), (work, "visible_types"), (work, "count")],
    "cache": [(cache, name) for name in ("pack", "store", "launches", "triples", "shared", "keep_only")],
    "loading the store": [
        (EmbeddedTransaction, name)
        for name in ("load", "replace_graphs", "replace_small_graphs", "patch_graph", "append", "count")
    ],
    "merging the store": [(EmbeddedTransaction, "commit")],
    "columns of what is loaded": [(Written, "load"), (Written, "patch"), (Written, "clear"), (Written, "take")],
    "writing packages": [(writing.Writing, name) for name in ("begin", "add", "finish")],
    "wiring systems": [(wiring, "wire")],
    "triples of systems": [(wiring, "system_triples")],
    "updating systems": [(systems, "update_systems")],
    "reading rules": [(reasoning, "rules_over")],
    "running rules": [(Reasoner, "infer"), (Runner, "run_within"), (Runner, "remember")],
}
"""The functions that begin each part."""


class InProcess:
    """Reads packages where the build runs, as a pool of no workers."""

    def __init__(self, job: Job, tasks: Iterable[Task], _jobs: int) -> None:
        self._job = job
        self._tasks = list(tasks)

    def __enter__(self) -> Self:
        gc.freeze()
        return self

    def __exit__(self, *_: object) -> None:
        gc.unfreeze()

    @property
    def size(self) -> int:
        """The number of processes that read packages."""
        return 1

    def outcomes(self) -> Iterator[Outcome]:
        """Yield the outcome of each task."""
        for task in self._tasks:
            yield work.work(self._job, task.source, task.path, task.earlier)


def main() -> None:
    """Build a checkout into a store that is thrown away, and print the figures."""
    clock = Clock(PARTS)
    clock.attach()
    setattr(pool, "Pool", InProcess)  # noqa: B010 - another class
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        clock.begin()
        build.build([sys.argv[1]], EmbeddedStore.create(Path(folder)), settings.load())
        clock.enter("rest")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(json.dumps({"seconds": clock.seconds, "megabytes": peak}))


if __name__ == "__main__":
    main()
