"""The summary of a build: what was read and found, unresolved names with reasons, and problems."""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.cli.diagnostics import note
from kg.cli.diagnostics import report as show
from kg.cli.fetching_view import entry_object
from kg.render.text import count, printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.facts import Problem
    from kg.pipeline.estimating import Volume
    from kg.pipeline.inferring import Inferred
    from kg.pipeline.report import BuildReport, SourceReport

_FEW: Final = 10
_FEW_REASONS: Final = 5


def summary(report: BuildReport, store: Path, *, every: bool) -> Iterator[str]:
    """Yield the lines about a finished build; `every` lists all problems and reasons."""
    sources = count(len(report.sources), "source")
    if report.generation is None:
        yield f"nothing changed in {count(report.reused, 'package')} of {sources} ({report.seconds:.2f} s)"
    else:
        removed = sum(source.removed for source in report.sources)
        unchanged = f", {report.reused:,} unchanged" if report.reused else ""
        gone = f", {removed:,} gone" if removed else ""
        yield f"read {count(report.read, 'package')} of {sources}{unchanged}{gone} in {report.seconds:.2f} s"
    kinds = (("nodes", "node"), ("interfaces", "interface"), ("parameters", "parameter"))
    counts = [count(report.total(key), noun) for key, noun in kinds]
    definitions = count(report.total("definitions"), "interface type")
    yield f"found {', '.join(counts)}, {definitions} in {count(report.total('files'), 'file')}"
    if report.systems and report.systems.configurations:
        instances = count(report.systems.instances, "instance")
        yield f"wired {instances} of {count(report.systems.configurations, 'launch file')}"
        yield from (f"  KG121 {failed}" for failed in report.systems.failed)
    inferred = report.inferred
    if inferred and inferred.mode == "none":
        yield "inferred nothing: the rules cannot run"
    elif inferred:
        changes = "" if inferred.mode == "full" else f" ({inferred.added:,} new, {inferred.removed:,} gone)"
        yield f"inferred {count(inferred.triples, 'triple')}{changes} in {inferred.seconds:.2f} s"
    yield from _unresolved(report, every=every)
    yield from _problems(report, every=every)
    yield f"store {near(store)}"


def _unresolved(report: BuildReport, *, every: bool) -> Iterator[str]:
    reasons = report.unresolved()
    total = report.total("unresolved")
    if not total:
        return
    yield f"{total:,} of {count(report.total('interfaces'), 'name')} unresolved:"
    shown = list(reasons.items())[: None if every else _FEW_REASONS]
    for reason, number in shown:
        yield f"  {number:>5,}  {printable(reason)}"
    others = total - sum(number for _, number in shown)
    if others > 0:
        yield f"  {others:>5,}  other reasons (`kg build --problems` lists all)"


def _problems_of(source: SourceReport) -> list[Problem]:
    return [*source.problems, *(one for package in source.packages for one in package.problems)]


def _problems(report: BuildReport, *, every: bool) -> Iterator[str]:
    listed = [(source, problem) for source in report.sources for problem in _problems_of(source)]
    if not listed:
        return
    files = len({(source.repository.name, problem.path) for source, problem in listed})
    yield f"problems {len(listed):,} in {count(files, 'file')}; the rest was built:"
    for source, problem in listed[: None if every else _FEW]:
        place = near(Path(source.repository.root) / problem.path)
        line = f":{problem.line}" if problem.line else ""
        yield f"  {printable(place)}{line}: {problem.code} {printable(problem.message)}"
    if not every and len(listed) > _FEW:
        yield f"  and {len(listed) - _FEW:,} more (`kg build --problems` lists all)"


def near(path: Path) -> str:
    """Return a path relative to the working folder if that is shorter."""
    relative = os.path.relpath(path)
    return str(path.resolve()) if relative.startswith("..") else relative


def left_out(inferred: Inferred | None) -> bool:
    """Warn of the rules that were left out; return whether there were any."""
    problems = inferred.problems if inferred else ()
    for problem in problems:
        show(problem, "warning")
    if problems and inferred and inferred.mode != "none":
        note("the other rules ran")
    return bool(problems)


def volume_row(volume: Volume) -> tuple[object, ...]:
    """Return the cells about a source in a build plan."""
    code = f"{volume.code_bytes / 1e6:.1f}"
    return volume.source, volume.packages, volume.reused, volume.files, code, f"{volume.reading:.1f}"


def volume_object(volume: Volume) -> dict[str, Any]:
    """Return a source in a build plan, with its estimates, for JSON."""
    return {
        **asdict(volume),
        "reading_seconds": round(volume.reading, 3),
        "writing_seconds": round(volume.writing, 3),
        "triples": volume.triples,
        "store_bytes": volume.store_bytes,
    }


def volumes_in_words(volumes: list[Volume]) -> Iterator[str]:
    """Yield the lines below the table of a build plan."""
    packages, code = sum(one.packages for one in volumes), sum(one.code_bytes for one in volumes)
    yield f"would read {count(packages, 'package')} with {code / 1e6:.1f} MB of code; nothing was read"
    if packages:
        reading, writing = sum(one.reading for one in volumes), sum(one.writing for one in volumes)
        yield (
            f"estimate: {reading:.0f} s of reading, divided by the number of processors, then {writing:.0f} s of "
            f"writing and rules; {sum(one.triples for one in volumes):,} triples, "
            f"{sum(one.store_bytes for one in volumes) / 1e6:,.0f} MB of disk"
        )


def report_object(report: BuildReport) -> dict[str, Any]:
    """Return the report as plain values for JSON."""
    keys = (
        "packages",
        "nodes",
        "interfaces",
        "parameters",
        "definitions",
        "files",
        "unresolved",
        "bounded",
        "problems",
        "triples",
    )
    return {
        "generation": report.generation,
        "seconds": round(report.seconds, 3),
        "jobs": report.jobs,
        "read": report.read,
        "reused": report.reused,
        "counts": {key: report.total(key) for key in keys},
        "unresolved": report.unresolved(),
        "systems": asdict(report.systems) if report.systems else None,
        "inferred": _inferred_object(report.inferred),
        "sources": [_source_object(source) for source in report.sources],
        "unfetched": [entry_object(entry) for entry in report.unfetched],
    }


def _inferred_object(inferred: Inferred | None) -> dict[str, Any] | None:
    if inferred is None:
        return None
    problems = [{"code": one.code, "message": one.message, "place": str(one.place or "")} for one in inferred.problems]
    return {**asdict(replace(inferred, problems=())), "seconds": round(inferred.seconds, 3), "problems": problems}


def _source_object(source: SourceReport) -> dict[str, Any]:
    return {
        "name": source.repository.name,
        "commit": source.repository.commit,
        "root": source.repository.root,
        "read": source.read,
        "reused": source.reused,
        "removed": source.removed,
        "problems": [
            {"code": one.code, "message": one.message, "file": one.path, "line": one.line}
            for one in _problems_of(source)
        ],
    }
