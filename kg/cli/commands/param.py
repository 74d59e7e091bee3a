"""`kg param`: one parameter, as code declares it and as launch and parameter files set it."""

from typing import Annotated

import typer

from kg.cli.commands.channels import All
from kg.cli.completion import parameters
from kg.cli.diagnostics import note
from kg.cli.options import Json, System, Via, with_settings
from kg.cli.output import Column, json_lines, line_width, listing, show, terminal
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import reading

with lazily():
    from kg.cli.endpoint_view import parameter_view, plain
    from kg.cli.links import Links
    from kg.views.evidence import places
    from kg.views.parameter import parameter

_HELP = "Name in the code (`rate`), in a parameter file (`FollowPath.speed`), `/node/rate`, or a part of one."
Name = Annotated[str, typer.Argument(metavar="NAME", help=_HELP, autocompletion=parameters, show_default=False)]


@with_settings("store")
def param(  # noqa: PLR0913 - the options of a command
    name: Name,
    *,
    settings: Settings,
    system: System = None,
    every: All = False,
    via: Via = False,
    json: Json = False,
) -> None:
    """Show the nodes that declare a parameter, and its value per launch file.

    Shows the line of code that declares it, its type and default, and the line of the launch or parameter file that
    sets it. A node started without a value uses the default. For example:

        kg param use_sim_time
        kg param /controller_server/controller_frequency
        kg param speed --system rover.launch --json
    """
    with reading(settings) as snapshot:
        described = parameter(snapshot, settings, name=name, system=system or "")
        if json:
            for one in [described["name"]] if described["name"] else described["meant"]:
                each = parameter(snapshot, settings, name=one, system=system or "")
                json_lines(plain(row) for row in (*each["declared"], *each["values"]))
            return
        links = Links(places(snapshot))
    if described["name"] is None:
        listing((Column("parameter", "name"),), [(one,) for one in described["meant"]])
        if terminal():
            note(f"{count(len(described['meant']), 'parameter')}; `kg param {described['meant'][0]}` shows one")
        return
    show(*parameter_view(described, links, line_width(), every=every, via=via))
