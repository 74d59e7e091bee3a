"""`kg diff`: what changed in interfaces and wiring between two commits, or two stores."""

from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.drawing import Output, Svg, deliver, form_of
from kg.cli.options import Families, Jobs, Json, Rules
from kg.cli.output import json_line
from kg.cli.session import session
from kg.errors import Exit, UsageError
from kg.render.text import count

if TYPE_CHECKING:
    from kg.cli.compared import Known, Sides
    from kg.launch.comparison import Difference

_SHOWN: Final = 12

Named = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="A..B", help="Two commits (A..B, A...B from their merge base, or A B), or the folders of two stores."
    ),
]
Repository = Annotated[
    str | None,
    typer.Option("--repository", "-C", metavar="FOLDER", help="Checkout to compare; by default this folder."),
]
Launch = Annotated[
    str | None, typer.Option("--launch", "-l", metavar="FILE", help="Compare only the wiring of this launch file.")
]
All = Annotated[
    bool,
    typer.Option("--all", "-a", help="Include what frameworks create implicitly, and in pictures what did not change."),
]
Markdown = Annotated[bool, typer.Option("--markdown", help="Write Markdown for a pull request.")]
ExitCode = Annotated[bool, typer.Option("--exit-code", help="Exit with 1 if there are differences.")]


def diff(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    named: Named = None,
    *,
    repository: Repository = None,
    launch: Launch = None,
    every: All = False,
    markdown: Markdown = False,
    svg: Svg = False,
    json: Json = False,
    output: Output = None,
    exit_code: ExitCode = False,
    jobs: Jobs = None,
    rules: Rules = None,
    rule_families: Families = None,
) -> None:
    """Show changes in interfaces and wiring between two commits.

    Compares node types and launched systems: names, types, quality of service, parameters, connections and findings
    that were added, removed or changed. Each commit is read once, into a store in your cache. Your work tree is not
    touched and nothing is fetched. For example:

        kg diff main..HEAD
        kg diff v1.2..v1.3 --markdown
        kg diff main...HEAD --launch rover.launch -o changes.svg
        kg diff before/.kg after/.kg
    """
    from kg.cli.compared import known, sides, stores  # noqa: PLC0415 - start-up time
    from kg.launch.comparison import compare  # noqa: PLC0415 - start-up time
    from kg.pipeline.launch_names import unknown_launch  # noqa: PLC0415 - start-up time

    form = form_of({"svg": svg, "markdown": markdown, "json": json}, output)
    asked = sides(named or (), repository)
    settings = session(context).settings(jobs=jobs, rules=rules, rule_families=rule_families)
    before, after = (known(store, settings, launch) for store in stores(asked, settings))
    if launch is not None and not (before.sources.systems or after.sources.systems):
        raise unknown_launch([*before.launches, *after.launches], launch)
    found = compare(before.sources, after.sources, every=every)
    deliver(_written(found, asked, (before, after), form, every=every), form, output, "diff")
    if found and exit_code:
        raise typer.Exit(Exit.FOUND)


def _written(found: "Difference", asked: "Sides", both: "tuple[Known, Known]", form: str, *, every: bool) -> str:
    from kg.cli.compared import address  # noqa: PLC0415 - start-up time
    from kg.cli.links import Links  # noqa: PLC0415 - start-up time
    from kg.launch.comparison.report import difference_lines, difference_markdown, difference_objects  # noqa: PLC0415 - as above

    if form == "svg":
        return _picture(found, asked, both, every=every)
    if form == "json":
        return "".join(map(json_line, difference_objects(found)))
    if form == "markdown":
        links = Links.of(both[0].states.values()), Links.of(both[1].states.values())
        return difference_markdown(found, asked.title, lambda side, is_after: address(links, side, is_after=is_after))
    return "".join(f"{line}\n" for line in difference_lines(found))


def _picture(found: "Difference", asked: "Sides", both: "tuple[Known, Known]", *, every: bool) -> str:
    from kg.launch.comparison.report import changed_keys  # noqa: PLC0415 - start-up time
    from kg.render.system_graph import SystemGraph, system_graph  # noqa: PLC0415 - start-up time
    from kg.render.system_svg import system_svg  # noqa: PLC0415 - start-up time
    from kg.render.system_views import collapsed, near_changes, overlaid  # noqa: PLC0415 - start-up time

    name = _one_system(found, both)
    title = f"{name} in {asked.title}"
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
    drawn = overlaid(before, after, changed_keys(found, name))
    return system_svg(collapsed(drawn if every else near_changes(drawn)))


def _one_system(found: "Difference", both: "tuple[Known, Known]") -> str:
    """Return the name of the launch file to be drawn: the one whose wiring differs, or that was named.

    KG003 where there are several, or none.
    """
    from kg.launch.comparison.report import changed_systems  # noqa: PLC0415 - start-up time

    names = changed_systems(found)
    if not names:
        names = tuple(sorted({one.configuration.name for side in both for one in side.sources.systems}))
    if len(names) == 1:
        return names[0]
    hint = "\n".join(f"`--launch {name}`" for name in names[:_SHOWN]) or "Omit the picture to compare interfaces."
    raise UsageError("KG003", f"{count(len(names), 'launch file')} could be drawn; one can", hint=hint)
