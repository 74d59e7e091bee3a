"""`kg build`: read sources into the store. `kg status`: the sources in the store, and their changes since."""

from dataclasses import asdict
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.copying import copy_to, server_of
from kg.cli.diagnostics import note, say
from kg.cli.options import Json, NoRules, UpdateUrl, with_settings
from kg.cli.output import Column, json_lines, listing, terminal
from kg.cli.supervising import supervise
from kg.errors import Exit
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import layout_of, mirrored, writable

if TYPE_CHECKING:
    from kg.corpus.files import Pin
    from kg.graph.source_states import SourceState
    from kg.store.remote import RemoteStore

with lazily():
    from kg.cli import fetching_view
    from kg.cli.build_view import left_out, report_object, summary, volume_object, volume_row, volumes_in_words
    from kg.cli.fetching_view import not_as_pinned
    from kg.cli.progress import for_people, for_this_stream
    from kg.corpus.fetching.lock import checkouts, read_lock, standing
    from kg.graph.source_states import sources
    from kg.pipeline.build import build as run
    from kg.pipeline.estimating import estimate
    from kg.pipeline.pending import pending, rules_changed
    from kg.store.embedded import EmbeddedStore

_WATCH_SECONDS: Final = 1.0

Sources = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="SOURCE",
        help="Folders, git addresses (URL or URL@REF), or files that list them; by default the sources read before.",
    ),
]
Watch = Annotated[
    bool, typer.Option("--watch", "-w", help="After the build, watch for changes and build again, until Ctrl-C.")
]
Corpus = Annotated[
    str | None,
    typer.Option(
        "--corpus",
        metavar="LOCK",
        help="Also build repositories of this lock file (`kg corpus fetch`); workers of a cluster fetch missing ones",
    ),
]
DryRun = Annotated[
    bool, typer.Option("--dry-run", help="Show how much would be read and about how long it takes; read nothing.")
]
Problems = Annotated[bool, typer.Option("--problems", help="List all problems and reasons, not only the first.")]


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
    rules_left_out, repositories_left_out = left_out(report.inferred), fetching_view.left_out(report.unfetched)
    return not (rules_left_out or repositories_left_out)


def _estimate(named: list[str], settings: Settings, *, json: bool) -> None:
    """List what a build would read of each source, and about how long that takes."""
    with for_people() as progress:
        volumes = estimate(named, settings, progress)
    columns = (
        Column("source", "name"),
        *(Column(title, "number") for title in ("packages", "unchanged", "files", "code MB", "s of reading")),
    )
    objects = map(volume_object, volumes) if json else None
    listing(columns, map(volume_row, volumes), objects=objects)
    for line in volumes_in_words(volumes):
        note(line)


def _watch(settings: Settings, server: "RemoteStore | None", *, problems: bool, infer: bool, json: bool) -> None:
    """Build again whenever a source has changed, until Ctrl-C, which is how watching ends."""
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
        *(Column(title, "number") for title in ("packages", "nodes", "unresolved", "bounded", "problems")),
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
