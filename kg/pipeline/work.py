"""Process one package in a worker: files to facts, facts to triples, triples to bytes."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.corpus.reading import DEFAULT_LIMIT_BYTES, Reader
from kg.extract.package import extract_package, guard
from kg.extract.snippets import read_snippets
from kg.facts import DataFile, FileKind, Known, LaunchConfiguration, PackageFacts, Problem, Resolution
from kg.graph.builds import count
from kg.graph.iris import Iris
from kg.graph.packages import package_parts
from kg.graph.shared import split
from kg.language.annotating import annotate
from kg.lazily import lazily
from kg.pipeline import cache
from kg.pipeline.recording import Lookup  # noqa: TC001 - outcomes are read by these annotations
from kg.pipeline.report import PackageResult
from kg.pipeline.visible import visible_types

if TYPE_CHECKING:
    from pathlib import Path

    from kg.corpus.files import PackageFolder, Source
    from kg.corpus.workspace import Workspace
    from kg.pipeline.recording import RecordingWorkspace

with lazily():
    from kg.launch.files import reading

_UNKNOWN: Final = (Resolution.UNRESOLVED, Resolution.PARTIAL)
_NO_REASON: Final = "no reason was noted"


@dataclass(frozen=True, slots=True)
class Job:
    """State shared by all workers: the build, the base of IRIs, the size limit of files in bytes.

    `calls` contains the users' descriptions of framework calls. `model` is the spaCy pipeline that tags descriptions,
    empty for the shipped one. `cache` is the folder of earlier results, None if there are none.
    """

    workspace: RecordingWorkspace
    base: str
    max_file_bytes: int
    model: str = ""
    cache: Path | None = None
    calls: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of one package: the result packed for the cache, and the data for the report and the next build.

    `outside` contains look-ups of files that no scan lists, with results; `visible` what can be started.
    """

    result: PackageResult
    inputs: dict[str, str]
    outside: dict[Lookup, str]
    packed: bytes
    visible: Known = field(default_factory=Known)
    reusable: bool = True


def work(job: Job, source: str, path: str, earlier: str = "") -> Outcome:
    """Extract the package in the folder `path` of a source; errors in the sources become problems.

    `earlier` is the name of its last result of the same version, whose tagged descriptions are reused.
    """
    began = time.perf_counter()
    scanned = job.workspace.source(source)
    package = next(one for one in scanned.packages if one.path == path) if scanned else None
    if scanned is None or package is None:
        raise LookupError(f"{source}:{path}")
    job.workspace.forget()
    facts = read_package(job.workspace, scanned, package, job.max_file_bytes, job.calls)
    tagged = cache.descriptions(job.cache, earlier) if job.cache and earlier else ()
    before = {one.text: one for one in tagged}
    facts = replace(facts, descriptions=annotate(facts.descriptions, job.model, before))
    iris = Iris(job.base)
    triples, stated = package_parts(facts, iris)
    own, shared = split(triples, iris)
    data = (DataFile(facts.repository, package.name, one.path, one.text) for one in facts.files if one.text is not None)
    stated, visible = visible_types(stated, facts.programs, data)
    counts = asdict(count([facts], triples=len(own) + len(shared)))
    result = PackageResult(
        source=source,
        name=package.name,
        path=path,
        counts=counts | {"launches": len(facts.launches)},
        unresolved=_reasons(facts),
        problems=facts.problems,
        seconds=time.perf_counter() - began,
    )
    record = job.workspace.lookups
    packed = cache.pack(b"".join(own), record, b"".join(shared), facts.launches, facts.descriptions, stated)
    return Outcome(result, dict(facts.inputs), job.workspace.outside, packed, visible)


def read_package(
    workspace: Workspace,
    source: Source,
    package: PackageFolder,
    max_file_bytes: int = DEFAULT_LIMIT_BYTES,
    calls: tuple[str, ...] = (),
) -> PackageFacts:
    """Return the declarations in the files of a package and the starts of its launch files; errors are in `problems`.

    Files larger than `max_file_bytes` are reported and not read. `calls` is as in `extract_package`.
    """
    reader = Reader(workspace, source, package, max_file_bytes)
    facts = extract_package(reader, calls)
    if any(entry.kind is FileKind.LAUNCH for entry in package.files):
        nothing: tuple[LaunchConfiguration, ...] = ()
        own = facts.package
        launches = guard(reader, reading.read_launches, nothing, reader, package, own.ros, own.also)
        facts = replace(facts, launches=launches, problems=reader.sorted_problems(), inputs=reader.inputs)
    return replace(facts, snippets=read_snippets(reader, facts))


def failed(source: str, name: str, path: str, message: str) -> Outcome:
    """Return the outcome of a package whose worker failed; the next build reads it again."""
    problem = Problem("KG121", message, path)
    result = PackageResult(source, name, path, {"problems": 1}, {}, (problem,))
    return Outcome(result, {}, {}, cache.pack(b"", {}), reusable=False)


def _reasons(facts: PackageFacts) -> dict[str, int]:
    names = [*(one for node in facts.nodes for one in node.interfaces if one.resolution in _UNKNOWN)]
    return dict(Counter(one.reason or _NO_REASON for one in names))
