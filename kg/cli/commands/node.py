"""`kg node`: one node with all it declares, as words, JSON or a picture."""

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from kg.cli.completion import nodes
from kg.cli.diagnostics import note
from kg.cli.drawing import deliver
from kg.cli.group import KgCommand
from kg.cli.interface_table import Row, interface_table
from kg.cli.options import All, Json, Via, with_settings
from kg.cli.output import json_lines, line_width, show, terminal, write, write_bytes
from kg.cli.systems import Launch
from kg.errors import UsageError
from kg.facts import Role
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import Settings
from kg.store.opening import reading
from kg.views.names import one_node, starting_system

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import RenderableType

    from kg.facts import InstanceInterface, NodeInstance, System
    from kg.graph.reading.classes import Classes
    from kg.graph.reading.nodes import NodeRecord
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from rich.text import Text

    from kg.cli.links import Links
    from kg.cli.node_view import left_out, node_lines
    from kg.graph.pictures import node_picture
    from kg.graph.reading.classes import classes
    from kg.graph.reading.systems import system_names, systems
    from kg.graph.records import instance_object, node_object
    from kg.graph.source_states import sources
    from kg.render import node_graph
    from kg.views.evidence import places
    from kg.views.node_graph import node_relations


_MOST_PARAMETERS: Final = 25
Name = Annotated[
    str,
    typer.Argument(
        metavar="NAME",
        help="Name of a node, `package/node`, `repository:package/node`, or the absolute name of an instance.",
        autocompletion=nodes,
    ),
]
Code = Annotated[bool, typer.Option("--code", help="Show the lines of code, from the store where files are not here.")]
Picture = Annotated[
    str | None,
    typer.Option(
        "--picture",
        metavar="[FILE.svg]",
        help="Draw the node as SVG to this file; by default to standard output, or on a terminal to NODE.svg.",
    ),
]
Graph = Annotated[
    bool,
    typer.Option(
        "--graph",
        help="Show the node with its entities and named relations; with --picture as SVG, or to FILE.dot for Graphviz.",
    ),
]


class NodeCommand(KgCommand):
    """A command whose option `--picture` may come without its file."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse, with an empty file behind `--picture` where what follows is no file of a picture."""
        spread: list[str] = []
        for argument, following in pairwise([*args, ""]):
            spread.append(argument)
            if argument == "--picture" and not (following.endswith((".svg", ".dot")) or following == "-"):
                spread.append("")
        return super().parse_args(ctx, spread)


@with_settings("store")
def node(  # noqa: PLR0913 - the options of a command
    name: Name,
    *,
    settings: Settings,
    launch: Launch = None,
    every: All = False,
    via: Via = False,
    code: Code = False,
    picture: Picture = None,
    graph: Graph = False,
    json: Json = False,
) -> None:
    """Show the interface of one node, with lines of code.

    Shows how to start the node, its purpose, its topics, services, actions and parameters, and the line behind each.
    For an instance, named as at run time, shows the launch line, remappings, parameters and resolved names. For
    example:

        kg node move_base
        kg node move_base/move_base --all --via
        kg node amcl --code
        kg node move_base --picture move_base.svg
        kg node amcl --picture amcl.svg --graph
        kg node /rover1/patrol --launch rover.launch
    """
    if name.startswith("/"):
        _instance(settings, name, launch, every=every, picture=picture, json=json)
        return
    if launch is not None:
        hint = f"Use the run-time name of an instance, such as `/{name}`."
        raise UsageError("KG003", "--launch chooses among instances", hint=hint)
    with reading(settings) as snapshot:
        records = one_node(snapshot, name)
        where = places(snapshot)
        lines = [node_lines(record, where, every=every) if code else () for record in records]
        inferred = [classes(snapshot, record.iri) for record in records]
        drawn = _related(snapshot, settings, records[0], picture, every=every) if graph and not json else ""
    if json:
        json_lines(map(node_object, records))
    elif graph and picture is None:
        write_bytes(drawn.encode())
    elif picture is not None:
        drawn = drawn or node_picture(records[0], implicit=every)
        deliver(drawn, "svg", picture or None, records[0].node.name.replace("/", "_"))
    else:
        for number, (record, inferred_classes, quoted) in enumerate(zip(records, inferred, lines, strict=True)):
            if number:
                write()
            _show(record, inferred_classes, Links(where), every=every, via=via)
            if quoted:
                show(*quoted)


def _instance(  # noqa: PLR0913 - the options of the command
    settings: Settings, name: str, launch: str | None, *, every: bool, picture: str | None, json: bool
) -> None:
    """Show what one launch file makes of a node."""
    with reading(settings) as snapshot:
        chosen = starting_system(snapshot, name, launch)
        names = system_names(snapshot, named=[chosen])
        read = systems(snapshot, names, settings.base)
        links = Links.of(sources(snapshot))
    pairs = [(system, one) for system in read for one in system.instances if one.name == name]
    if picture is not None:
        hint = f"`kg graph {chosen} --focus {name} -o FILE.svg` draws it with its neighbours."
        raise UsageError("KG003", "--picture draws node types", hint=hint)
    if json:
        json_lines(instance_object(*pair) for pair in pairs)
        return
    for number, (system, one) in enumerate(pairs):
        if number:
            write()
        show(*instance_view(system, one, links, line_width(), every=every))


def _show(record: "NodeRecord", inferred: "Classes", links: "Links", *, every: bool, via: bool) -> None:
    from kg.cli.node_view import node_view  # noqa: PLC0415 - start-up time

    most = _MOST_PARAMETERS if terminal() else None
    show(*node_view(record, links, line_width(), every=every, via=via, most=most, classes=inferred))
    hidden = 0 if every else left_out(record.node)
    if hidden:
        note(f"{count(hidden, 'implicit entry', 'implicit entries')} created by frameworks hidden; --all shows them")


def _related(
    snapshot: "EmbeddedSnapshot", settings: Settings, record: "NodeRecord", picture: str | None, *, every: bool
) -> str:
    """Return the entities and relations of a node, in the form that is asked for."""
    from kg.views.node import node as node_view  # noqa: PLC0415 - start-up time

    relations = node_relations(node_view(snapshot, settings, iri=record.iri), every=every)
    name = record.node.name
    if picture is None:
        return "".join(f"{line}\n" for line in node_graph.node_graph_lines(name, relations))
    if picture.endswith(".dot"):
        return node_graph.node_graph_dot(name, relations)
    return node_graph.node_graph_svg(name, relations)


def instance_view(
    system: "System", instance: "NodeInstance", links: "Links", columns: int, *, every: bool
) -> "tuple[RenderableType, ...]":
    """Return the output for an instance at a width in columns; `every` adds the endpoints of frameworks."""
    repository = system.configuration.repository
    ends = [end for end in instance.interfaces if every or not end.declared.implicit]
    groups = [(role.heading, [_end(end, repository) for end in ends if end.declared.role is role]) for role in Role]
    remaps = [
        Row(one.source, one.target, "" if one.used else "changes nothing", one.remap.location, dim=False)
        for one in instance.remaps
    ]
    settings = [
        Row(
            one.name,
            "(not known)" if one.set.value is None else one.set.value,
            one.set.reason or "",
            one.set.location,
            dim=False,
        )
        for one in instance.parameters
    ]
    groups += [("remappings, from and to", remaps), ("parameters", settings)]
    nonempty = [(title, rows) for title, rows in groups if rows]
    parts: list[RenderableType] = list(_header(system, instance))
    if nonempty:
        parts += [Text(), interface_table(nonempty, repository, links, columns)]
    return tuple(parts)


def _header(system: "System", instance: "NodeInstance") -> "Iterator[Text]":
    started = instance.started
    yield Text.assemble((printable(instance.name), "bold"), f"  {started.kind} of ROS {system.configuration.ros}")
    fields = (
        ("system", system.configuration.name),
        ("node", f"{instance.started_type}{f' ({instance.reason})' if instance.reason else ''}"),
        ("started", " > ".join(map(str, (*started.chain, started.location)))),
        ("if", started.condition),
        ("host", instance.host),
        ("loads", ", ".join(f"{one.package}/{one.node}" for one in instance.plugins)),
        ("arguments", " ".join(started.arguments)),
    )
    for name, value in fields:
        if value:
            yield Text.assemble((f"  {name:<9} ", "dim"), printable(value))


def _end(end: "InstanceInterface", repository: str) -> Row:
    declared, location = end.declared, end.declared.location
    words = [
        f"{declared.name or declared.written} in the code" if declared.name != end.resolved else "",
        f"remapped at {end.remap.location}" if end.remap else "",
        f"named by the parameter {end.parameter.name} at {end.parameter.location}" if end.parameter else "",
        end.reason or "",
    ]
    if location.repository is None and end.owner.repository != repository:
        location = replace(location, repository=end.owner.repository)
    remark = ", ".join(filter(None, words))
    return Row(
        end.resolved or "(not resolved)", declared.type or "(type not known)", remark, location, declared.implicit
    )
