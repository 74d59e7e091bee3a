"""`kg diff`: changes in interfaces and wiring between two commits. `kg impact`: what breaks if a name changes."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.completion import subjects
from kg.cli.drawing import Output, Svg, deliver, form_of
from kg.cli.options import Json, Markdown, argument, option, with_settings
from kg.cli.output import json_line
from kg.errors import Exit, StoreError, UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.impact.model import Impact
    from kg.store.embedded import EmbeddedStore


with lazily():
    from kg.cli.links import Links
    from kg.cli.progress import for_people
    from kg.graph.reading.nodes import node_records
    from kg.graph.reading.systems import SystemName, system_names
    from kg.graph.source_states import SourceState, sources
    from kg.impact import writing
    from kg.launch.comparison import Difference, Side, Sources, compare, report
    from kg.pipeline.launch_names import matching, several_launches, unknown_launch
    from kg.pipeline.revisions import commit_and_work_tree, merge_base, resolve, revision_store
    from kg.render.system_graph import SystemGraph, system_graph
    from kg.render.system_svg import system_svg
    from kg.render.system_views import collapsed, near_changes, overlaid
    from kg.store.opening import existing, reading
    from kg.views.evidence import Places, places
    from kg.views.impact import broken_between, compared_sources, impact_of


_SHOWN: Final = 12

Named = Annotated[
    list[str] | None,
    argument("A..B", "Two commits (A..B, A...B from their merge base, or A B), or the folders of two stores."),
]
Repository = Annotated[str | None, option("--repository -C FOLDER", "Checkout to compare; by default this folder.")]
Launch = Annotated[str | None, option("--launch -l FILE", "Compare only the wiring of this launch file.")]
With = Annotated[
    str | None,
    option(
        "--with FILE", "Compare the launch file of --launch with this one; without commits, both are from the store."
    ),
]
All = Annotated[
    bool, option("--all -a", "Include what frameworks create implicitly, and in pictures what did not change.")
]
ExitCode = Annotated[bool, option("--exit-code", "Exit with 1 if there are differences.")]


@with_settings("store", "jobs", "rules", "rule_families")
def diff(  # noqa: PLR0913 - the options of a command
    named: Named = None,
    *,
    settings: Settings,
    repository: Repository = None,
    launch: Launch = None,
    other: With = None,
    every: All = False,
    markdown: Markdown = False,
    svg: Svg = False,
    json: Json = False,
    output: Output = None,
    exit_code: ExitCode = False,
) -> None:
    """Show changes in interfaces and wiring between two commits.

    Compares node types and launched systems: names, types, quality of service, parameters, connections and findings
    that were added, removed or changed. Each commit is read once, into a store in your cache. Your work tree is not
    touched and nothing is fetched. For example:

        kg diff main..HEAD
        kg diff v1.2..v1.3 --markdown
        kg diff main...HEAD --launch rover.launch -o changes.svg
        kg diff before/.kg after/.kg
        kg diff --launch robot.launch --with simulation.launch
    """
    form = form_of({"svg": svg, "markdown": markdown, "json": json}, output)
    if other is not None:
        if launch is None:
            raise UsageError("KG003", "--with needs a launch file to compare with", hint="Name it: `--launch FILE`.")
        compared = sides(named, repository) if named else Sides(launch, other)
        first, second = stores(compared, settings) if named else (existing(settings),) * 2
        one, two = read_side(first, settings, launch), read_side(second, settings, other)
        before, after = as_one(one, two, (launch, other))
    else:
        compared = sides(named or (), repository)
        before, after = (read_side(store, settings, launch) for store in stores(compared, settings))
        if launch is not None and not (before.sources.systems or after.sources.systems):
            raise unknown_launch([*before.launches, *after.launches], launch)
    difference = compare(before.sources, after.sources, every=every)
    deliver(_written(difference, compared, (before, after), form, every=every), form, output, "diff")
    if difference and exit_code:
        raise typer.Exit(Exit.FOUND)


def _written(
    difference: "Difference", compared: "Sides", both: "tuple[SideData, SideData]", form: str, *, every: bool
) -> str:
    if form == "svg":
        return _picture(difference, compared, both, every=every)
    if form == "json":
        return "".join(map(json_line, report.difference_objects(difference)))
    if form == "markdown":
        links = Links.of(both[0].states.values()), Links.of(both[1].states.values())
        return report.difference_markdown(
            difference, compared.title, lambda side, is_after: address(links, side, is_after=is_after)
        )
    return "".join(f"{line}\n" for line in report.difference_lines(difference))


def _picture(difference: "Difference", compared: "Sides", both: "tuple[SideData, SideData]", *, every: bool) -> str:
    name = _one_system(difference, both)
    title = f"{name} in {compared.title}"
    before, after = (
        next(
            (
                system_graph(one, every=every, title=title)
                for one in side.sources.systems
                if one.configuration.name == name
            ),
            SystemGraph(title, (), (), ()),
        )
        for side in both
    )
    drawn = overlaid(before, after, report.changed_keys(difference, name))
    return system_svg(collapsed(drawn if every else near_changes(drawn)))


def _one_system(difference: "Difference", both: "tuple[SideData, SideData]") -> str:
    """Return the name of the launch file to be drawn: the one whose wiring differs, or that was named.

    KG003 where there are several, or none.
    """
    names = report.changed_systems(difference)
    if not names:
        names = tuple(sorted({one.configuration.name for side in both for one in side.sources.systems}))
    if len(names) == 1:
        return names[0]
    hint = "\n".join(f"`--launch {name}`" for name in names[:_SHOWN]) or "Omit the picture to compare interfaces."
    raise UsageError("KG003", f"{count(len(names), 'launch file')} could be drawn; one can", hint=hint)


@dataclass(frozen=True, slots=True)
class Sides:
    """The request: two stores, or two commits of `repository`; `since` for three dots."""

    before: str
    after: str
    repository: Path | None = None
    since: bool = False

    @property
    def title(self) -> str:
        """The title of the comparison."""
        if self.repository is None:
            return f"{self.before} and {self.after}"
        return f"{self.before}{'...' if self.since else '..'}{self.after}"


@dataclass(frozen=True, slots=True)
class SideData:
    """The data of one side: nodes and systems, the states of its sources, and the names of its launch files."""

    sources: "Sources"
    states: "Mapping[str, SourceState]"
    launches: "Sequence[SystemName]"


def sides(named: "Sequence[str]", repository: str | None) -> "Sides":
    """Return the sides of the arguments: `A..B`, `A...B`, `A B`; two folders are stores. KG003 for anything else."""
    folder = Path(repository or ".")
    if len(named) == 1 and ".." in named[0]:
        dots = "..." if "..." in named[0] else ".."
        before, _, after = named[0].partition(dots)
        return Sides(before or "HEAD", after or "HEAD", folder, since=dots == "...")
    if len(named) == 2:  # noqa: PLR2004 - a before and an after
        if repository is None and all(Path(name).is_dir() for name in named):
            return Sides(named[0], named[1])
        return Sides(named[0], named[1], folder)
    hint = (
        f"`kg diff {named[0]}..HEAD` compares it with the last commit."
        if named
        else "For example: `kg diff main..HEAD`."
    )
    raise UsageError("KG003", "name two commits or two stores to compare", hint=hint)


def stores(compared: "Sides", settings: Settings) -> "tuple[EmbeddedStore, EmbeddedStore]":
    """Return both stores; commits without a store are built now. Raises as `kg.pipeline.revisions` does."""
    if compared.repository is None:
        first, second = (existing(replace(settings, store=Path(name))) for name in (compared.before, compared.after))
        return first, second
    before, after = resolve(compared.repository, compared.before), resolve(compared.repository, compared.after)
    if compared.since:
        before = merge_base(compared.repository, before, after)
    opened = []
    for revision in (before, after):
        with for_people() as progress:
            opened.append(revision_store(compared.repository, revision, settings, progress))
    return opened[0], opened[1]


def read_side(store: "EmbeddedStore", settings: Settings, launch: str | None) -> "SideData":
    """Return the data of a side; with `launch` only that of the launch files it may name."""
    with store.read() as snapshot:
        every = system_names(snapshot)
        if launch is None:
            read = compared_sources(snapshot, settings, node_records(snapshot), every)
        else:
            read = compared_sources(snapshot, settings, [], matching(every, launch))
        return SideData(read, {one.name: one for one in sources(snapshot)}, every)


def as_one(before: "SideData", after: "SideData", texts: tuple[str, str]) -> "tuple[SideData, SideData]":
    """Return both sides with the launch file of the second under the name of that of the first.

    Raises KG422, KG003 if one of `texts` names no launch file of its side, or several.
    """
    for side, text in zip((before, after), texts, strict=True):
        if not side.sources.systems:
            raise unknown_launch(side.launches, text)
        if len(side.sources.systems) > 1:
            raise several_launches(side.launches, matching(side.launches, text), text)
    (one,), (two,) = before.sources.systems, after.sources.systems
    name = one.configuration
    renamed = replace(two.configuration, package=name.package, path=name.path, folder=name.folder)
    findings = [replace(each, system=name.name) for each in after.sources.findings]
    return before, replace(after, sources=Sources([], [replace(two, configuration=renamed)], findings))


def address(links: "tuple[Links, Links]", side: "Side", *, is_after: bool) -> str | None:
    """Return the address of a line's page on the forge; None if the source is not a commit of a forge."""
    if side.location is None or not side.repository:
        return None
    link = links[is_after].to(side.repository, side.location)
    return link if link and link.startswith("https://") else None


Name = Annotated[
    str | None,
    argument(
        "NAME",
        "A topic, service, action, `package/Type`, `package/Type.field`, `node.parameter`, node, launch argument "
        "(`x.launch:argument`) or file.",
        autocompletion=subjects,
    ),
]
KindOf = Annotated[str | None, option("--kind -k KIND", "Kind of NAME, if it is ambiguous.")]
Diff = Annotated[
    str | None, option("--diff -d COMMIT", "Show what the work tree breaks elsewhere, compared with COMMIT.")
]
Checkout = Annotated[str | None, option("--repository -C FOLDER", "Checkout for --diff; by default this folder.")]
BreakingCode = Annotated[bool, option("--exit-code", "Exit with 1 if something breaks.")]


@with_settings("store")
def impact(  # noqa: PLR0913 - the options of a command
    name: Name = None,
    *,
    settings: Settings,
    diff: Diff = None,
    repository: Checkout = None,
    kind: KindOf = None,
    markdown: Markdown = False,
    json: Json = False,
    output: Output = None,
    exit_code: BreakingCode = False,
) -> None:
    """Show what breaks if a name is renamed, removed or changed.

    Searches code, launch files, parameter files and definitions, and shows each place with its line. `breaks` is
    certain; `may` states why it is uncertain. For example:

        kg impact /cmd_vel
        kg impact geometry_msgs/Twist.linear
        kg impact amcl.base_frame_id
        kg impact bringup.launch:use_sim_time --json
        kg impact --diff origin/main --markdown

    With --diff, each difference between COMMIT and the current files is shown with what it breaks in unchanged places.
    The store is not changed.
    """
    form = form_of({"markdown": markdown, "json": json}, output)
    if (name is None) == (diff is None):
        raise UsageError("KG003", "a name or --diff COMMIT is required", hint="`kg impact /cmd_vel`, for example.")
    if diff is not None:
        is_breaking, text = _of_commit(settings, diff, Path(repository or "."), form)
    else:
        with reading(settings) as snapshot:
            effects = impact_of(snapshot, settings, name or "", kind or "")
            is_breaking, text = effects.is_breaking, _impact_text(effects, form, places(snapshot))
    deliver(text, form, output, "impact")
    if exit_code and is_breaking:
        raise typer.Exit(Exit.FOUND)


def _of_commit(settings: Settings, commit: str, folder: Path, form: str) -> tuple[bool, str]:
    try:
        store = existing(settings)
    except StoreError:
        if settings.store is not None:
            raise
        store = None
    revision = resolve(folder, commit)
    with for_people() as progress, commit_and_work_tree(folder, revision, store, settings, progress) as (before, after):
        broken = broken_between(before, after, settings)
    is_breaking = any(one.is_breaking for one in broken)
    if form == "json":
        return is_breaking, "".join(map(json_line, writing.broken_objects(broken)))
    if form == "markdown":
        return is_breaking, writing.broken_markdown(broken, f"{commit}..work tree")
    return is_breaking, "".join(f"{line}\n" for line in writing.broken_lines(broken))


def _impact_text(effects: "Impact", form: str, where: "Places") -> str:
    if form == "json":
        return json_line(writing.impact_object(effects))
    if form == "markdown":
        return writing.impact_markdown(effects, where.web)
    return "".join(f"{line}\n" for line in writing.impact_lines(effects))
