"""Reads sources into the records of `kg nodes --json`, straight from extraction, in a few processes."""

from __future__ import annotations

import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

from kg.corpus.workspace import Workspace, scan
from kg.graph.reading.nodes import NodeRecord
from kg.graph.records import node_object
from kg.pipeline.work import read_package

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from kg.corpus.workspace import Source
    from kg.facts import PackageFacts, Repository

__all__ = ["Reading", "read_sources"]

_WORKSPACES: list[Workspace] = []
"""What the worker processes inherit when they are forked, so that no source is sent to them package by package."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What was read of one source: its records, its problems as text, and the CPU seconds that each package took."""

    repository: Repository
    records: list[dict[str, Any]]
    problems: list[str]
    seconds: dict[str, float]


def read_sources(roots: Iterable[Path], *, together: bool, workers: int, package: str | None) -> list[Reading]:
    """Read each source as a build of its own, or all as one build (`together`); only `package` if one is named."""
    sources = [scan(root) for root in roots]
    _WORKSPACES[:] = [Workspace(sources)] if together else [Workspace([source]) for source in sources]
    tasks = [
        (number, source.repository.name, folder.path, str(source.root))
        for number, workspace in enumerate(_WORKSPACES)
        for source in workspace.sources
        for folder in sorted(source.packages, key=lambda folder: -len(folder.files))
        if package in (None, folder.name)
    ]
    done: dict[str, list[tuple[PackageFacts, float]]] = {str(source.root): [] for source in sources}
    with ProcessPoolExecutor(workers, mp_context=get_context("fork")) as pool:
        for task, result in zip(tasks, pool.map(_extract, tasks, chunksize=2), strict=True):
            done[task[3]].append(result)
    return [_reading(source, done[str(source.root)]) for source in sources]


def _extract(task: tuple[int, str, str, str]) -> tuple[PackageFacts, float]:
    number, repository, path, root = task
    workspace = _WORKSPACES[number]
    source = next(s for s in workspace.sources if s.repository.name == repository and str(s.root) == root)
    folder = next(folder for folder in source.packages if folder.path == path)
    start = time.process_time()
    facts = read_package(workspace, source, folder)
    return facts, time.process_time() - start


def _reading(source: Source, results: list[tuple[PackageFacts, float]]) -> Reading:
    records = [record for facts, _ in results for record in _records(source.repository, facts)]
    problems = [
        f"{facts.package.name}: {found.path}:{found.line or 1}: {found.code} {found.message}"
        for facts, _ in results
        for found in facts.problems
    ]
    return Reading(source.repository, records, problems, {facts.package.name: seconds for facts, seconds in results})


def _records(repository: Repository, facts: PackageFacts) -> Iterator[dict[str, Any]]:
    for node in facts.nodes:
        yield node_object(NodeRecord(repository.name, repository.commit, facts.package.name, node))
