"""`kg build`: read sources into the store. `kg status`: the sources in the store, and their changes since."""

import os
from dataclasses import asdict, replace
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from kg.cli.diagnostics import note, say
from kg.cli.diagnostics import report as show
from kg.cli.options import Json, NoRules, UpdateUrl, argument, option, with_settings
from kg.cli.output import Column, json_lines, listing, numbers, terminal
from kg.cli.supervising import supervise
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import Settings
from kg.store.opening import layout_of, mirrored, writable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import Pin
    from kg.facts import Problem
    from kg.pipeline.inferring import Inferred
    from kg.pipeline.report import BuildReport, SourceReport


with lazily():
    from kg.cli.commands.corpus import entry_object, not_as_pinned, report_unfetched
    from kg.cli.progress import for_people, for_this_stream
    from kg.corpus.fetching.lock import checkouts, read_lock, standing
    from kg.graph.source_states import SourceState, sources
    from kg.pipeline.build import build as run
    from kg.pipeline.estimating import estimate, pending, rules_changed
    from kg.store.embedded import EmbeddedStore
    from kg.store.remote import RemoteStore
    from kg.store.remote_reading import without_credentials
    from kg.store.replacing import replace_on


_WATCH_SECONDS: Final = 1.0

Sources = Annotated[
    list[str] | None,
    argument(
        "SOURCE",
        "Folders, git addresses (URL or URL@REF), or files that list them; by default the sources read before.",
    ),
]
Watch = Annotated[bool, option("--watch -w", "After the build, watch for changes and build again, until Ctrl-C.")]
Corpus = Annotated[
    str | None,
    option(
        "--corpus LOCK",
        "Also build repositories of this lock file (`kg corpus fetch`); workers of a cluster fetch missing ones",
    ),
]
DryRun = Annotated[bool, option("--dry-run", "Show how much would be read and about how long it takes; read nothing.")]
Problems = Annotated[bool, option("--problems", "List all problems and reasons, not only the first.")]


@with_settings(
    "jobs",
    "cluster",
    "artifacts",
    "max_file_bytes",
    "memory",
    "nlp_model",
    "base",
    "calls",
    "rules",
    "rule_families",
    "store",
)
def build(  # noqa: PLR0913 - the options of a command
    sources: Sources = None,
    *,
    settings: Settings,
    corpus: Corpus = None,
    problems: Problems = False,
    dry_run: DryRun = False,
    watch: Watch = False,
    no_rules: NoRules = False,
    json: Json = False,
    update_url: UpdateUrl = None,
) -> None:
    """Read ROS packages into the store.

    Nodes and their interfaces are extracted from the source code; nothing is compiled or run. A second build reads
    only what has changed. Unreadable files are reported and the rest is built. Rules then infer further facts. If a
    build is interrupted or reaches the `memory` limit, the store is unchanged. For example:

        kg build ~/catkin_ws/src
        kg build https://github.com/ros-planning/navigation.git@noetic-devel
        kg build --corpus robots/corpus.lock.toml
        kg build
        kg build --cluster tcp://scheduler:8786 --artifacts /shared/kg SOURCE...
        kg build --cluster tcp://scheduler:8786 --artifacts /shared/kg --corpus corpus.lock.toml
        kg build --store http://localhost:7878/query --update-url http://localhost:7878/update SOURCE...
    """
    if settings.memory:
        supervise(settings.memory)
    server = server_of(settings, update_url)
    if server is not None:
        settings = mirrored(settings)
    elsewhere = bool(settings.cluster) and not dry_run
    checkouts, whole = _checkouts(corpus, elsewhere=elsewhere) if corpus else ({}, True)
    named = [*(sources or ()), *checkouts]
    pins = {folder: pin for folder, pin in checkouts.items() if pin}
    if dry_run:
        _estimate(named, settings, json=json)
        return
    sound = _build(named, settings, server, pins, problems=problems, infer=not no_rules, json=json) and whole
    if watch:
        _watch(settings, server, problems=problems, infer=not no_rules, json=json)
    elif not sound:
        raise typer.Exit(Exit.FOUND)


def _checkouts(corpus: str, *, elsewhere: bool) -> "tuple[dict[str, Pin | None], bool]":
    """Return the folders of a corpus, and whether all match its lock file; list those that do not.

    With `elsewhere`, missing repositories that have a commit are included, with their pins.
    """
    lock = read_lock(Path(corpus))
    state = standing(lock, elsewhere=elsewhere)
    not_as_pinned(lock, state)
    return checkouts(lock, state), not state.missing and not state.drifted


def _build(  # noqa: PLR0913 - the options of the command
    named: list[str],
    settings: Settings,
    server: "RemoteStore | None",
    pins: "dict[str, Pin]",
    *,
    problems: bool,
    infer: bool,
    json: bool,
) -> bool:
    """Build, report the results, and return whether all rules could be used and all repositories fetched."""
    with writable(settings, create=bool(named)) as target, for_this_stream() as progress:
        report = run(named, target, settings, progress, " ".join(["kg build", *named]), rules=infer, pins=pins)
    for line in summary(report, target.layout.root, every=problems):
        say(line)
    if server is not None:
        copy_to(server, target)
    if json:
        json_lines([report_object(report)])
    rules_left_out, repositories_left_out = left_out(report.inferred), report_unfetched(report.unfetched)
    return not (rules_left_out or repositories_left_out)


def _estimate(named: list[str], settings: Settings, *, json: bool) -> None:
    """List what a build would read of each source, and about how long that takes."""
    with for_people() as progress:
        volumes = estimate(named, settings, progress)
    columns = (Column("source", "name"), *numbers("packages", "unchanged", "files", "code MB", "s of reading"))
    objects = (
        {
            **asdict(one),
            "reading_seconds": round(one.reading, 3),
            "writing_seconds": round(one.writing, 3),
            "triples": one.triples,
            "store_bytes": one.store_bytes,
        }
        for one in volumes
    )
    rows = [
        (one.source, one.packages, one.reused, one.files, f"{one.code_bytes / 1e6:.1f}", f"{one.reading:.1f}")
        for one in volumes
    ]
    listing(columns, rows, objects=objects if json else None)
    packages, code = sum(one.packages for one in volumes), sum(one.code_bytes for one in volumes)
    note(f"would read {count(packages, 'package')} with {code / 1e6:.1f} MB of code; nothing was read")
    if packages:
        reading, writing = sum(one.reading for one in volumes), sum(one.writing for one in volumes)
        note(
            f"estimate: {reading:.0f} s of reading, divided by the number of processors, then {writing:.0f} s of "
            f"writing and rules; {sum(one.triples for one in volumes):,} triples, "
            f"{sum(one.store_bytes for one in volumes) / 1e6:,.0f} MB of disk"
        )


def _watch(settings: Settings, server: "RemoteStore | None", *, problems: bool, infer: bool, json: bool) -> None:
    layout = layout_of(settings)
    note("watching the sources; press Ctrl-C to stop")
    try:
        while True:
            sleep(_WATCH_SECONDS)
            if any(pending(layout, settings).values()):
                _build([], settings, server, {}, problems=problems, infer=infer, json=json)
    except KeyboardInterrupt:
        say()


@with_settings("rules", "rule_families", "store")
def status(*, settings: Settings, json: Json = False) -> None:
    """List the sources in the store and what has changed since the build.

    Shows each source's commit, packages, nodes, unresolved names, nodes that reached a limit of the interpretation
    (`bounded`), and packages that a build would read again. Reports whether rules were added, edited or removed since
    they last ran.
    """
    layout = layout_of(settings)
    with EmbeddedStore(layout).read() as snapshot:
        states, quads, generation = sources(snapshot, counted=True), snapshot.count(), snapshot.generation
    changed = pending(layout, settings)
    columns = (
        Column("source", "name"),
        Column("commit"),
        Column("changed"),
        *numbers("packages", "nodes", "unresolved", "bounded", "problems"),
        Column("read", spare=1),
        Column("folder", "dim", spare=1),
    )
    rows = [_row(one, changed) for one in states]
    objects = ({**asdict(one), "changed": changed.get(one.name)} for one in states)
    listing(columns, rows, objects=objects if json else None)
    if not json and rules_changed(layout, settings):
        note("rules have changed since they last ran, or some could not run; run `kg rules run`")
    if terminal() and not json:
        note(f"{count(quads, 'quad')} in generation {generation} of {layout.root}")
        if any(changed.values()):
            note("`kg build` reads the changes")


def _row(state: "SourceState", changed: dict[str, tuple[str, ...] | None]) -> tuple[object, ...]:
    counts = state.counts
    commit = f"{state.commit[:12]}{' + changes' if state.dirty else ''}" if state.commit else "-"
    numbers = (counts.packages, counts.nodes, counts.unresolved, counts.bounded, counts.problems)
    read = (state.read or "").partition(".")[0].replace("T", " ")
    packages = changed.get(state.name, ())
    if state.name not in changed:
        change = "not built here"
    elif packages is None:
        change = "no longer exists"
    else:
        change = count(len(packages), "package") if packages else "-"
    return state.name, commit, change, *numbers, read, state.root


_FEW: Final = 10
_FEW_REASONS: Final = 5


def summary(report: "BuildReport", store: Path, *, every: bool) -> "Iterator[str]":
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


def _unresolved(report: "BuildReport", *, every: bool) -> "Iterator[str]":
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


def _problems_of(source: "SourceReport") -> "list[Problem]":
    return [*source.problems, *(one for package in source.packages for one in package.problems)]


def _problems(report: "BuildReport", *, every: bool) -> "Iterator[str]":
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


def left_out(inferred: "Inferred | None") -> bool:
    """Warn of the rules that were left out; return whether there were any."""
    problems = inferred.problems if inferred else ()
    for problem in problems:
        show(problem, "warning")
    if problems and inferred and inferred.mode != "none":
        note("the other rules ran")
    return bool(problems)


def report_object(report: "BuildReport") -> dict[str, Any]:
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


def _inferred_object(inferred: "Inferred | None") -> dict[str, Any] | None:
    if inferred is None:
        return None
    problems = [{"code": one.code, "message": one.message, "place": str(one.place or "")} for one in inferred.problems]
    return {**asdict(replace(inferred, problems=())), "seconds": round(inferred.seconds, 3), "problems": problems}


def _source_object(source: "SourceReport") -> dict[str, Any]:
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


_SERVER_SECONDS: Final = 3600.0
"""Seconds for a server to replace graphs."""


def server_of(settings: Settings, update_url: str | None) -> "RemoteStore | None":
    """Return the server that the settings name as the store, None if that is a folder.

    Raises:
        UsageError: KG002 if a file of settings names the server, KG003 for an address of updates without a server.
        StoreError: KG225 for an address with credentials.
    """
    if not isinstance(settings.store, str):
        if update_url:
            raise UsageError("KG003", "--update-url needs a server, but the store is a folder")
        return None
    layout_of(settings)  # refuses a server that a file of settings names

    for address in filter(None, (settings.store, update_url)):
        without_credentials(address)
    return RemoteStore(settings.store, update_url, timeout=_SERVER_SECONDS, from_environment=True)


def copy_to(server: "RemoteStore", store: "EmbeddedStore") -> None:
    """Replace the graphs of a server that differ from those of a store, and report it."""
    sent = replace_on(store.layout, server)
    removed = f", removed {sent.removed:,}" if sent.removed else ""
    say(f"wrote {count(sent.graphs, 'graph')} with {count(sent.triples, 'triple')}{removed} to {server.address}")
    if sent.missing > 0:
        note(f"the server stored {count(sent.missing, 'triple')} less, because it regards some values as equal")
