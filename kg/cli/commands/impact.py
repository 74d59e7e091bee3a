"""`kg impact`: what breaks if a name is renamed, removed or changed."""

from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.drawing import Output, deliver, form_of
from kg.cli.options import Json, Store
from kg.cli.output import json_line
from kg.cli.session import session
from kg.errors import Exit

if TYPE_CHECKING:
    from kg.impact import Impact
    from kg.views.evidence import Places

__all__ = ["impact"]

Name = Annotated[
    str,
    typer.Argument(
        metavar="NAME",
        help="A topic, service, action, `package/Type`, `package/Type.field`, `node.parameter`, node, launch argument "
        "(`x.launch:argument`) or file.",
    ),
]
KindOf = Annotated[
    str | None, typer.Option("--kind", "-k", metavar="KIND", help="What NAME is, where it means several things.")
]
Markdown = Annotated[bool, typer.Option("--markdown", help="Write Markdown for a pull request.")]
ExitCode = Annotated[bool, typer.Option("--exit-code", help="End with 1 if something breaks.")]


def impact(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    name: Name,
    *,
    kind: KindOf = None,
    markdown: Markdown = False,
    json: Json = False,
    output: Output = None,
    exit_code: ExitCode = False,
    store: Store = None,
) -> None:
    """Show what breaks if a name is renamed, removed or changed.

    In code, launch files, parameter files and definitions, each with its line. `breaks` is certain; `may` has the
    reason why it is not. For example:

        kg impact /cmd_vel
        kg impact geometry_msgs/Twist.linear
        kg impact amcl.base_frame_id
        kg impact bringup.launch:use_sim_time --json
    """
    from kg.store.opening import reading  # noqa: PLC0415 - start-up time
    from kg.views.evidence import places  # noqa: PLC0415 - start-up time
    from kg.views.impact import impact_of  # noqa: PLC0415 - start-up time

    form = form_of({"markdown": markdown, "json": json}, output)
    settings = session(context).settings(store=store)
    with reading(settings) as snapshot:
        found = impact_of(snapshot, settings, name, kind or "")
        where = places(snapshot)
    deliver(_written(found, form, where), form, output, "impact")
    if exit_code and found.is_breaking:
        raise typer.Exit(Exit.FOUND)


def _written(found: "Impact", form: str, where: "Places") -> str:
    from kg.impact.writing import impact_lines, impact_markdown, impact_object  # noqa: PLC0415 - start-up time

    if form == "json":
        return json_line(impact_object(found))
    if form == "markdown":
        return impact_markdown(found, where.web)
    return "".join(f"{line}\n" for line in impact_lines(found))
