"""Checking of a store, or of folders.

Folders are built into a store below the user's cache directory, so a check does not touch the folder or an existing
store. The next check of the same folders reads only changes.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.codes import LINT_CODES
from kg.errors import StoreError, UsageError
from kg.graph.iris import Iris
from kg.graph.reading.systems import SystemName, included, system_names
from kg.graph.source_states import SourceState, sources
from kg.lazily import lazily
from kg.lint import baseline as baselines
from kg.lint.allowing import Comments, allowances
from kg.lint.reading import read_findings
from kg.lint.report import Choice, Report, report
from kg.pipeline.launch_names import find, shared_names
from kg.settings import Settings, table
from kg.similar import unknown
from kg.store.layout import user_cache
from kg.store.opening import existing, reading, writable

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.lint.finding import Finding
    from kg.lint.question import Question
    from kg.pipeline.report import BuildReport
    from kg.pipeline.report import Report as Progress
    from kg.store.embedded import EmbeddedStore
    from kg.store.interface import Queryable

with lazily():
    from kg.pipeline.build import build
    from kg.pipeline.launching import chosen, trial
    from kg.pipeline.variants import variants


_PATIENCE: Final = 300.0
"""Seconds to wait for another check of the same folders."""
_PAUSE: Final = 0.5


@dataclass(frozen=True, slots=True)
class Checked:
    """The report, the sources of the store, and the number of checked systems."""

    report: Report
    sources: tuple[SourceState, ...]
    systems: int
    left_out: tuple[str, ...] = ()
    """Variants of the launch file that were not checked."""

    @property
    def roots(self) -> dict[str, str]:
        """The folders of the sources by name."""
        return {one.name: one.root for one in self.sources if one.root}


def own_store(folders: Iterable[Path]) -> Path:
    """Return the store of some folders in the user's cache."""
    named = sorted(str(folder.resolve()) for folder in folders)
    digest = blake2b("\0".join(named).encode(errors="surrogateescape"), digest_size=8).hexdigest()
    return user_cache() / "lint" / f"{Path(named[0]).name}-{digest}"


def read_folders(
    folders: Sequence[Path], settings: Settings, progress: Progress | None = None
) -> tuple[Settings, BuildReport]:
    """Build folders into a store of their own; return the settings for that store, and the result of the build.

    It waits while another check builds the same folders, for example in tests of several packages.

    Raises:
        SourceError: KG101 an unreadable folder.
        StoreError: KG302 the other check takes minutes, KG306 the cache is not writable.
    """
    given = replace(settings, store=own_store(folders))
    end = time.monotonic() + _PATIENCE
    while True:
        try:
            with writable(given) as store:
                return given, build([str(folder) for folder in folders], store, given, progress, "kg lint")
        except StoreError as error:
            if error.code != "KG302" or time.monotonic() > end:
                raise
            time.sleep(_PAUSE)


def check_store(settings: Settings, question: Question, folder: Path) -> Checked:
    """Return the report on the current store, evaluating launch files again if arguments or variables are given.

    `folder` is where kg.toml is searched for. Nothing is written.

    Raises:
        SourceError: KG101 with arguments, and the source has moved since the build.
        StoreError: KG301 no store, KG302 with arguments, while another process is writing.
        UnknownNameError: KG001 a code that no finding can have.
        UsageError: KG002 and KG421 for kg.toml, KG420 for the baseline, KG422 and KG003 for the launch file.
    """
    if not question.variants and not question.arguments and not question.environment:
        with reading(settings) as snapshot:
            return check(snapshot, question, settings, folder)
    store = existing(settings)
    if question.variants:
        return _check_variants(settings, store, question, folder)

    (system,) = chosen(settings, store, question.launch, question.arguments, question.environment)
    with trial(settings, store, system) as transaction:
        return check(transaction, question, settings, folder)


def _check_variants(settings: Settings, store: EmbeddedStore, question: Question, folder: Path) -> Checked:
    """Return the report on a launch file, with findings that only its variants have."""
    if question.launch is None:
        raise UsageError("KG003", "--variants needs a launch file", hint="Name it: `--launch FILE`.")
    states = variants(settings, store, question.launch, question.arguments, question.environment)
    with trial(settings, store, states.system) as transaction:
        checked = check(transaction, question, settings, folder)
    present = {one.fingerprint for one in (*checked.report.raw, *checked.report.allowed, *checked.report.baselined)}
    only: dict[str, tuple[Finding, list[str]]] = {}
    for label, system in states.others:
        with trial(settings, store, system) as transaction:
            for one in check(transaction, question, settings, folder).report.findings:
                if one.fingerprint not in present:
                    only.setdefault(one.fingerprint, (one, []))[1].append(label)
    added = [replace(one, message=f"{one.message} (only with {' or '.join(labels)})") for one, labels in only.values()]
    findings = tuple(sorted((*checked.report.findings, *added), key=lambda one: one.order))
    whole = replace(checked.report, findings=findings, raw=(*checked.report.raw, *added))
    return replace(checked, report=whole, left_out=states.left_out)


def check(graph: Queryable, question: Question, settings: Settings, folder: Path) -> Checked:
    """Return the report on the content of a store; see `check_store`."""
    states = tuple(sources(graph))
    roots = {one.name: one.root for one in states if one.root}
    names = system_names(graph)
    own = shared_names(names)
    iris = Iris(settings.base)
    labels = {iris.configuration(one.repository, one.path): text for one, text in own.items()}
    findings = read_findings(graph, settings.base, labels=labels)
    _require_codes(question.codes, {one.code for one in findings})
    chosen = _systems(question, names, roots, own)
    choice = Choice(chosen, frozenset(question.codes), question.level, every=question.every)
    entries = allowances(table("lint", folder), {one.code for one in findings})
    baseline = baselines.read(question.baseline) if question.baseline else None
    comments = Comments(roots)
    inner = included(graph, labels)
    reported = report(findings, choice, included=inner, entries=entries, comments=comments, baseline=baseline)
    return Checked(reported, states, len(names) if chosen is None else len(chosen))


def _require_codes(codes: Iterable[str], there: set[str]) -> None:
    """Raise `UnknownNameError` (KG001) for a code of kg that no finding can have; own rules choose their codes."""
    known = there | LINT_CODES
    for code in codes:
        if code.startswith("KG") and code not in known:
            raise unknown("code", code, known, otherwise="`kg explain` lists the codes.")


def _systems(
    question: Question, names: Sequence[SystemName], roots: Mapping[str, str], own: Mapping[SystemName, str]
) -> frozenset[str] | None:
    """Return the names of the selected configurations; None for all."""
    if question.launch is not None:
        wanted = find(names, question.launch, roots)
        return frozenset({own.get(wanted, wanted.name)})
    if question.package is not None:
        source, _, package = question.package.rpartition(":")
        mine = [one for one in names if source in {"", one.repository}]
        return frozenset(own.get(one, one.name) for one in mine if one.name.partition("/")[0] == package)
    return None
