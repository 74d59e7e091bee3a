"""`kg topic`, `kg service`, `kg action`: one name with all its ends, in launched systems and in code."""

from collections.abc import Callable
from typing import Annotated

import typer

from kg.cli import completion
from kg.cli.commands.lists import channel_rows
from kg.cli.diagnostics import note
from kg.cli.options import Json, System, Via, with_settings
from kg.cli.output import json_lines, line_width, show, terminal
from kg.lazily import lazily
from kg.render.text import count, some
from kg.settings import Settings
from kg.store.opening import reading

with lazily():
    from kg.cli.endpoint_view import endpoint_view, plain
    from kg.cli.links import Links
    from kg.views.channel import channel
    from kg.views.evidence import places

_MOST = 5  # so many names are listed in a note
_HELP = "Name in a system (`/{0}`), name in the code (`{0}` or `~/{0}`), or a part of either."
All = Annotated[bool, typer.Option("--all", "-a", help="Show a row for each launch file.")]


def _command(kind: str, example: str, text: str) -> Callable[..., None]:
    """Return the command that shows one name of a kind; `text` is its manual."""
    name_of_kind = typer.Argument(
        metavar="NAME", help=_HELP.format(example), autocompletion=completion.channels(kind), show_default=False
    )

    def command(  # noqa: PLR0913 - the options of a command
        name: Annotated[str, name_of_kind],
        *,
        settings: Settings,
        system: System = None,
        every: All = False,
        via: Via = False,
        json: Json = False,
    ) -> None:
        with reading(settings) as snapshot:
            described = channel(snapshot, settings, kind=kind, name=name, system=system or "")
            others = [one["name"] for one in described["meant"]]
            if json:
                names = [described["name"], *others] if described["name"] else others
                for one in names:
                    ends = channel(snapshot, settings, kind=kind, name=one, system=system or "")["endpoints"]
                    json_lines(map(plain, ends))
                return
            links = Links(places(snapshot))
        if described["name"] is None:
            channel_rows(kind, described["meant"])
            if terminal():
                note(f"{count(len(others), kind)}; `kg {kind} {others[0]}` shows one")
            return
        show(*endpoint_view(described, links, line_width(), every=every, via=via))
        if others:
            note(f"`{name}` in the code is also {some(others, _MOST)}")

    command.__doc__ = text
    return with_settings("store")(command)


topic = _command(
    "topic",
    "scan",
    """Show a topic's publishers and subscribers, by launch file and in code.

    Each row is one line of code in one start of a node, with its QoS, the line that starts it, and the number of
    launch files that include that line. More than three starts that differ in that line alone are one row. Incompatible
    types and QoS are listed below, as `kg lint` reports them. For example:

        kg topic /cmd_vel
        kg topic cmd_vel --system rover.launch
        kg topic vel --json
    """,
)
service = _command("service", "reset", "Show a service's servers and clients; works like `kg topic`.")
action = _command("action", "dock", "Show an action's servers and clients; works like `kg topic`.")
