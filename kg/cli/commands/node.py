"""`kg node`: one node with all it declares, as words, JSON or a picture."""

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from kg.cli.completion import nodes
from kg.cli.diagnostics import note, say
from kg.cli.group import KgCommand
from kg.cli.names import one_node
from kg.cli.options import Json, Store
from kg.cli.output import json_lines, line_width, show, terminal, write, write_bytes
from kg.cli.session import session
from kg.errors import Place, UsageError
from kg.render.text import count
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.cli.links import Links
    from kg.graph.reading import NodeRecord

__all__ = ["NodeCommand", "node"]

_MOST_PARAMETERS: Final = 25
Name = Annotated[
    str,
    typer.Argument(
        metavar="NAME", help="Name of the node, or `package/node`, or `repository:package/node`.", autocompletion=nodes
    ),
]
All = Annotated[bool, typer.Option("--all", "-a", help="Also what frameworks make by themselves (rosout, tf, ...).")]
Picture = Annotated[
    str | None,
    typer.Option(
        "--picture",
        metavar="[FILE.svg]",
        help="Draw it as SVG: into the file, else to standard output, or on a terminal to NODE.svg.",
    ),
]


class NodeCommand(KgCommand):
    """A command whose option `--picture` may come without its file."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse, with an empty file behind `--picture` where what follows is no SVG file."""
        spread: list[str] = []
        for argument, following in pairwise([*args, ""]):
            spread.append(argument)
            if argument == "--picture" and not (following.endswith(".svg") or following == "-"):
                spread.append("")
        return super().parse_args(ctx, spread)


def node(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    name: Name,
    *,
    every: All = False,
    picture: Picture = None,
    json: Json = False,
    store: Store = None,
) -> None:
    """Show one node: its interface, with lines of code.

    How to start it, what it publishes, subscribes, offers and calls, its parameters, and the line behind each.
    For example:

        kg node move_base
        kg node move_base/move_base --all
        kg node move_base --picture move_base.svg
    """
    from kg.cli.links import Links  # noqa: PLC0415 - start-up time
    from kg.graph.records import node_object  # noqa: PLC0415 - start-up time
    from kg.graph.source_states import sources  # noqa: PLC0415 - start-up time

    with reading(session(context).settings(store=store)) as snapshot:
        records = one_node(snapshot, name)
        links = Links.of(sources(snapshot))
    if json:
        json_lines(map(node_object, records))
    elif picture is not None:
        _draw(records[0], picture, every=every)
    else:
        for number, record in enumerate(records):
            if number:
                write()
            _show(record, links, every=every)


def _show(record: "NodeRecord", links: "Links", *, every: bool) -> None:
    from kg.cli.node_view import left_out, node_view  # noqa: PLC0415 - start-up time

    show(*node_view(record, links, line_width(), every=every, most=_MOST_PARAMETERS if terminal() else None))
    hidden = 0 if every else left_out(record.node)
    if hidden:
        note(f"{count(hidden, 'implicit entry', 'implicit entries')} made by frameworks not shown; --all shows them")


def _draw(record: "NodeRecord", file: str, *, every: bool) -> None:
    from kg.graph.pictures import node_picture  # noqa: PLC0415 - start-up time

    drawn = node_picture(record, implicit=every).encode()
    if file == "-" or not (file or terminal()):
        write_bytes(drawn)
        return
    path = Path(file or f"{record.node.name.replace('/', '_')}.svg")
    try:
        path.write_bytes(drawn)
    except OSError as error:
        raise UsageError("KG003", f"the picture cannot be written: {error.strerror}", place=Place(str(path))) from error
    say(f"wrote {path}")
