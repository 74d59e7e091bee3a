"""From a store, or from folders, to the report that faces show.

Folders are read into a store of their own below the user's cache directory, so that a check leaves no trace in the
folder and does not touch a store that is there; the second check of the same folders reads only what has changed.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING

from kg.errors import UsageError
from kg.graph.choosing import meant
from kg.graph.source_states import sources
from kg.graph.systems_reading import system_names
from kg.lint import baseline as baselines
from kg.lint.allowing import Comments, allowances
from kg.lint.reading import included, read_findings
from kg.lint.report import Choice, Report, report
from kg.query.similar import did_you_mean
from kg.settings import Settings, table
from kg.store.opening import writable

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.graph.reading import Queryable
    from kg.graph.systems_reading import SystemName
    from kg.pipeline.report import BuildReport
    from kg.pipeline.report import Report as Progress

__all__ = ["Checked", "Question", "check", "own_store", "read_folders"]


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked: see `kg lint --help`. `launch` names a launch file, `package` the package that it must be of."""

    launch: str | None = None
    package: str | None = None
    codes: frozenset[str] = frozenset()
    level: str = "note"
    every: bool = False
    baseline: Path | None = None


@dataclass(frozen=True, slots=True)
class Checked:
    """The report, and what faces need to show it: folders of the sources by name, the number of systems looked at."""

    report: Report
    roots: Mapping[str, str]
    systems: int


def own_store(folders: Iterable[Path]) -> Path:
    """Return where the store of some folders stands: below `$XDG_CACHE_HOME`, by default `~/.cache`."""
    named = sorted(str(folder.resolve()) for folder in folders)
    digest = blake2b("\0".join(named).encode(errors="surrogateescape"), digest_size=8).hexdigest()
    given = os.environ.get("XDG_CACHE_HOME", "")
    cache = Path(given) if Path(given).is_absolute() else Path.home() / ".cache"
    return cache / "kg" / "lint" / f"{Path(named[0]).name}-{digest}"


def read_folders(
    folders: Sequence[Path], settings: Settings, progress: Progress | None = None
) -> tuple[Settings, BuildReport]:
    """Read folders into a store of their own; return the settings for that store, and what was read.

    Raises:
        SourceError: KG101 when a folder cannot be read.
        StoreError: KG302 while another check of the same folders is under way, KG306 when the cache is not writable.
    """
    from kg.pipeline.build import build  # noqa: PLC0415 - who asks a store loads no reader of sources

    given = replace(settings, store=own_store(folders))
    with writable(given) as store:
        return given, build([str(folder) for folder in folders], store, given, progress, "kg lint")


def check(graph: Queryable, question: Question, settings: Settings, folder: Path) -> Checked:
    """Return the report about a store; `folder` is where kg.toml is looked for and paths are relative to.

    Raises:
        UsageError: KG002 and KG421 for kg.toml, KG420 for the baseline, KG422 for the launch file.
    """
    roots = {one.name: one.root or "" for one in sources(graph)}
    names = system_names(graph)
    findings = read_findings(graph, settings.base)
    chosen = _systems(question, names, roots, folder)
    choice = Choice(chosen, question.codes, question.level, every=question.every)
    entries = allowances(table("lint", folder), {one.code for one in findings})
    known = baselines.read(question.baseline) if question.baseline else None
    comments = Comments(roots)
    found = report(findings, choice, included=included(graph), entries=entries, comments=comments, baseline=known)
    return Checked(found, roots, len(names) if chosen is None else len(chosen))


def _systems(
    question: Question, names: Sequence[SystemName], roots: Mapping[str, str], folder: Path
) -> frozenset[str] | None:
    """Return the names of the configurations that are asked about; None for all."""
    if question.launch is not None:
        return frozenset({_launch(question.launch, names, roots, folder).name})
    if question.package is not None:
        source, _, package = question.package.rpartition(":")
        mine = [one for one in names if source in {"", one.repository}]
        return frozenset(one.name for one in mine if one.name.partition("/")[0] == package)
    return None


def _launch(text: str, names: Sequence[SystemName], roots: Mapping[str, str], folder: Path) -> SystemName:
    found = meant(text, names, roots.items(), folder)
    if len(found) == 1:
        return found[0]
    if found:
        lines = "\n".join(f"`{one.name}`  ({one.repository}: {one.path})" for one in found)
        raise UsageError("KG422", f"{len(found)} launch files are meant by `{text}`; say which", hint=lines)
    known = {name for one in names for name in (one.name, one.path, one.path.rpartition("/")[2])}
    raise UsageError("KG422", f"there is no launch file `{text}` in the build", hint=did_you_mean(text, known))
