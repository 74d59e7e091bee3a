"""`kg node`: one node with all it declares, as words, JSON or a picture."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Final

from kg.cli.completion import nodes
from kg.cli.diagnostics import note
from kg.cli.drawing import deliver
from kg.cli.group import KgCommand
from kg.cli.options import All, Json, Via, argument, option, with_settings
from kg.cli.output import json_lines, line_width, shortened, show, terminal, write, write_bytes
from kg.cli.systems import Launch
from kg.errors import UsageError
from kg.facts import (
    InstanceInterface,
    Location,
    NodeInstance,
    NodeKind,
    NodeType,
    Parameter,
    PluginSlot,
    Role,
    StartKind,
    System,
)
from kg.holes import ANONYMOUS
from kg.lazily import lazily
from kg.names import join
from kg.render.text import NAME_UNKNOWN, TYPE_UNKNOWN, VALUE_UNKNOWN, count, printable, some, width
from kg.settings import Settings
from kg.store.opening import reading
from kg.views.names import one_node, starting_system
from kg.views.wording import LANGUAGES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from rich.console import RenderableType

    from kg.graph.reading.nodes import NodeRecord
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    from kg.cli.links import Links
    from kg.graph.iris import Iris
    from kg.graph.pictures import node_picture
    from kg.graph.reading.classes import Class, Classes, classes
    from kg.graph.reading.systems import system_names, systems
    from kg.graph.records import how_to_start, instance_object, node_object
    from kg.graph.source_states import sources
    from kg.render import node_graph
    from kg.views.evidence import Places, places
    from kg.views.node import users
    from kg.views.node_graph import node_relations
    from kg.views.wording import accesses, how, how_loaded, parameter_groups, quality, quoted


_GAP: Final = 3
_LEAST_REMARK: Final = 16


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the table; `dim` for endpoints that a framework creates."""

    name: str
    type: str
    remark: str
    location: "Location"
    dim: bool
    via: "tuple[Location, ...]" = ()
    """The calls from the location to the framework, shown below the location."""


@dataclass(frozen=True, slots=True)
class _Layout:
    """How places are written, and whether remarks are below the types; if it `fits`, only remarks are folded."""

    places: "Mapping[Location, str]"
    stacked: bool = False
    fits: bool = True


def interface_table(
    groups: "Sequence[tuple[str, Sequence[Row]]]", repository: str, links: "Links", columns: int
) -> "Table":
    """Return a rich table of groups with their titles, for a terminal of so many columns."""
    from rich.box import SIMPLE_HEAD  # noqa: PLC0415 - start-up time

    rows = [row for _, listed in groups for row in listed]
    layout = _layout(rows, columns)
    table = Table(box=SIMPLE_HEAD, show_header=False, pad_edge=False, show_edge=False, padding=(0, 2, 0, 0))
    for title in ("name", "type", "remark", "place"):
        if title != "remark" or not layout.stacked:
            folds = title == ("type" if layout.stacked else "remark") or not layout.fits
            table.add_column(overflow="fold", no_wrap=not folds)
    for number, (title, listed) in enumerate(groups):
        if number:
            table.add_row()
        table.add_row(Text(title, style="bold cyan"))
        for row in listed:
            style = "dim" if row.dim else ""
            name = Text(f"  {printable(row.name)}", style=style or "bold")
            places = [place_text(one, repository, links, layout.places[one]) for one in (row.location, *row.via)]
            middle = [printable(row.type), printable(row.remark)]
            if layout.stacked:
                middle = ["\n".join(filter(None, middle))]
            table.add_row(name, *(Text(text, style=style) for text in middle), Text("\nvia ", style="dim").join(places))
    return table


def place_text(location: "Location", repository: str, links: "Links", shown: str | None = None) -> "Text":
    """Return a place as rich text with a link to the file."""
    address = links.to(repository, location)
    text = _where(location) if shown is None else shown
    return Text(printable(text), style=f"dim link {address}" if address else "dim")


def _where(location: "Location") -> str:
    return f"{location.repository}:{location}" if location.repository else str(location)


def _layout(rows: "Sequence[Row]", columns: int) -> "_Layout":
    """Return the first layout that fits; the last one is folded if necessary."""
    locations = list(dict.fromkeys(one for row in rows for one in (row.location, *row.via)))
    forms = [dict(zip(locations, form, strict=True)) for form in shortened([_where(one) for one in locations])]
    whole, without_shared, names = forms
    remark = max(width(row.remark) for row in rows)
    types = max(width(row.type) for row in rows)
    sides = max(width(row.name) for row in rows) + 2 + types + _GAP
    calls = len("via ") if any(row.via for row in rows) else 0
    choices = ((whole, remark), (without_shared, remark), (names, min(remark, _LEAST_REMARK)))
    for places, room in choices:
        last = max(map(width, places.values())) + calls
        if sides + room + 2 * _GAP + last <= columns:
            return _Layout(places)
    last = max(map(width, names.values())) + calls
    return _Layout(names, stacked=True, fits=sides + _GAP + last <= columns)


_MOST_PARAMETERS: Final = 25
Name = Annotated[
    str,
    argument(
        "NAME",
        "Name of a node, `package/node`, `repository:package/node`, or the absolute name of an instance.",
        autocompletion=nodes,
    ),
]
Code = Annotated[bool, option("--code", "Show the lines of code, from the store where files are not here.")]
Picture = Annotated[
    str | None,
    option(
        "--picture [FILE.svg]",
        "Draw the node as SVG to this file; by default to standard output, or on a terminal to NODE.svg.",
    ),
]
Graph = Annotated[
    bool,
    option(
        "--graph",
        "Show the node with its entities and named relations; with --picture as SVG, or to FILE.dot for Graphviz.",
    ),
]


class NodeCommand(KgCommand):
    """A command whose option `--picture` may come without its file."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse, with an empty file behind `--picture` where what follows is no file of a picture."""
        spread: list[str] = []
        for word, following in pairwise([*args, ""]):
            spread.append(word)
            if word == "--picture" and not (following.endswith((".svg", ".dot")) or following == "-"):
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

    Shows how to start the node, its purpose, its topics, services, actions and parameters, and the launch files that
    start it, each with its line.
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
        shown = [] if json or graph or picture is not None else records
        lines = [node_lines(record, where, every=every) if code else () for record in shown]
        starts = [_starts(users(snapshot, record.iri, where, Iris(settings.base)), record) for record in shown]
        inferred = [classes(snapshot, record.iri) for record in shown]
        drawn = _related(snapshot, settings, records[0], picture, every=every) if graph and not json else ""
    if json:
        json_lines(map(node_object, records))
    elif graph and picture is None:
        write_bytes(drawn.encode())
    elif picture is not None:
        drawn = drawn or node_picture(records[0], implicit=every)
        deliver(drawn, "svg", picture or None, records[0].node.name.replace("/", "_"))
    else:
        for number, (record, quoted) in enumerate(zip(shown, lines, strict=True)):
            if number:
                write()
            _show(record, inferred[number], starts[number], Links(where), every=every, via=via)
            if quoted:
                show(*quoted)


def _instance(  # noqa: PLR0913 - the options of the command
    settings: Settings, name: str, launch: str | None, *, every: bool, picture: str | None, json: bool
) -> None:
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


def _starts(used: "Mapping[str, Any]", record: "NodeRecord") -> "list[Row]":
    """Return a row for each launch line and name of a node, with the launch files that include the line."""
    systems: dict[tuple[str, Location], list[str]] = {}
    for one in used["instances"]:
        place = one["evidence"]
        source = None if place["repository"] == record.repository else place["repository"]
        location = Location(place["path"], place["line"] or 0, source)
        systems.setdefault((one["name"], location), []).append(one["system"])
    rows = []
    for (name, location), every in systems.items():
        included = every if len(every) > 1 or not location.path.endswith(every[0].partition("/")[2]) else ()
        by = f"in {included[0] if len(included) == 1 else count(len(included), 'launch file')}" if included else ""
        rows.append(Row(name, by, "", location, dim=False))
    return rows


def _show(  # noqa: PLR0913 - what is shown, and how much of it
    record: "NodeRecord", inferred: "Classes", starts: "Sequence[Row]", links: "Links", *, every: bool, via: bool
) -> None:
    most = _MOST_PARAMETERS if terminal() else None
    columns = line_width()
    show(*node_view(record, links, columns, every=every, via=via, most=most, classes=inferred, starts=starts))
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
            VALUE_UNKNOWN if one.set.value is None else one.set.value,
            one.set.reason or "",
            one.set.location,
            dim=False,
        )
        for one in instance.parameters
    ]
    groups += [("remappings, from and to", remaps), ("parameters", settings)]
    nonempty = [(title, rows) for title, rows in groups if rows]
    parts: list[RenderableType] = list(_instance_header(system, instance))
    if nonempty:
        parts += [Text(), interface_table(nonempty, repository, links, columns)]
    return tuple(parts)


def _instance_header(system: "System", instance: "NodeInstance") -> "Iterator[Text]":
    started = instance.started
    kind = "further node of its program" if started.kind is StartKind.INNER else str(started.kind)
    yield Text.assemble((printable(instance.name), "bold"), f"  {kind}, ROS {system.configuration.ros}")
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


def _end(end: "InstanceInterface", repository: str) -> "Row":
    declared, location = end.declared, end.declared.location
    plain = (declared.name or "").removeprefix("~").strip("/")
    is_evident = plain and not end.remap and (end.resolved or "").endswith(f"/{plain}")
    words = [
        "" if is_evident else f"{declared.name or declared.written} in the code",
        f"remapped at {end.remap.location}" if end.remap else "",
        f"named by the parameter {end.parameter.name} at {end.parameter.location}" if end.parameter else "",
        end.reason or "",
        quality(end.switches, end.qos),
    ]
    if location.repository is None and end.owner.repository != repository:
        location = replace(location, repository=end.owner.repository)
    remark = ", ".join(filter(None, words))
    return Row(end.resolved or NAME_UNKNOWN, declared.type or TYPE_UNKNOWN, remark, location, declared.implicit)


_MOST_DESCRIPTIONS: Final = 2  # maximum number of descriptions shown by default; the best come first
_MOST_SOURCES: Final = 4
_MOST_STARTS: Final = 5


def node_view(  # noqa: PLR0913 - what is shown, and how much of it
    record: "NodeRecord",
    links: "Links",
    columns: int,
    *,
    every: bool,
    via: bool = False,
    most: int | None = None,
    classes: "Classes | None" = None,
    starts: "Sequence[Row]" = (),
) -> "tuple[RenderableType, ...]":
    """Return the output for a node at a width in columns; `every` adds the endpoints of frameworks.

    `via` adds the calls from a line of the node's package to the framework, if they are in other files. `most` limits
    the number of parameters, so a terminal still shows the interface. `classes` is the result of rules, `starts` has a
    row for each launch line.

    If lines are too narrow for whole paths, their beginnings are cut; the links still lead to the file.
    """
    parts: list[RenderableType] = list(_type_header(record, links))
    found = classes or Classes()
    parts.append(Text.assemble(_field("function", ""), _listed(found.functions) if found.functions else "unknown"))
    if found.hardware or found.devices:
        parts.append(Text.assemble(_field("hardware", ""), _listed((*found.hardware, *found.devices))))
    texts = record.descriptions if every else record.descriptions[:_MOST_DESCRIPTIONS]
    for one in texts:
        place = Text.assemble(("  ", "dim"), place_text(one.location, record.repository, links))
        parts += [Text(), Padding(Text(printable(one.text)), (0, 0, 0, 2)), place]
    if len(texts) < len(record.descriptions):
        hidden = count(len(record.descriptions) - len(texts), "more text")
        parts.append(Text(f"  and {hidden}; --all shows all", style="dim"))
    groups = _groups(record.node, every=every, via=via)
    if record.node.slots:
        groups.append(("plugins it loads", [_slot(one, record, via=via) for one in record.node.slots]))
    if groups:
        parts += [Text(), interface_table(groups, record.repository, links, columns)]
    # One row per parameter, even if code reads and writes it at many places.
    by_name = parameter_groups(fact for fact in record.node.parameters if every or not fact.implicit)
    parameters = [_parameter(group, via=via) for group in by_name]
    shown = parameters if every else parameters[:most]
    if shown:
        parts += [Text(), interface_table([("parameters", shown)], record.repository, links, columns)]
    if len(shown) < len(parameters):
        parts.append(Text(f"  and {len(parameters) - len(shown):,} more; --all shows them", style="dim"))
    if starts:
        few = starts if every else starts[:_MOST_STARTS]
        parts += [Text(), interface_table([("started as", few)], record.repository, links, columns)]
        if len(few) < len(starts):
            parts.append(Text(f"  and {len(starts) - len(few):,} more; --all shows them", style="dim"))
    return tuple(parts)


def node_lines(record: "NodeRecord", where: "Places", *, every: bool) -> "tuple[Text, ...]":
    """Return the statements of a node, its interfaces and parameters, by place, each below its place."""
    node = record.node
    locations = {node.location, *(one.location for one in node.slots)}
    locations.update(one.location for one in node.interfaces if every or not one.implicit)
    locations.update(one.location for one in node.parameters if every or not one.implicit)
    lines = []
    for place in sorted(locations, key=lambda one: (one.repository or "", one.path, one.line)):
        if code := quoted(where.code(record.repository, place, whole=True)):
            lines += [Text(str(place), style="dim"), Text(f"  {printable(code)}")]
    return (Text(), Text("lines of code", style="bold cyan"), *lines) if lines else ()


def left_out(node: NodeType) -> int:
    """Return the number of implicit entries of a node."""
    return sum(one.implicit for one in node.interfaces) + sum(one.implicit for one in node.parameters)


def _type_header(record: "NodeRecord", links: "Links") -> "Iterable[Text]":
    node = record.node
    language = LANGUAGES.get(node.language, node.language)
    yield Text.assemble((printable(node.name), "bold"), f"  {language} {node.kind} for ROS {node.ros}")
    commit = f" at {record.commit[:12]}" if record.commit else ""
    yield _field("package", f"{record.package} ({record.repository}{commit})")
    start = how_to_start(record)
    if start:
        yield _field("start", start)
    elif node.kind is NodeKind.CLASS:
        yield _field("start", "not on its own: a class that programs instantiate as nodes")
    if node.plugin:
        text = _field("plugin", node.plugin + (f" (a {node.base_class})" if node.base_class else ""))
        if node.exported is not None:
            text = text.append(" by ", style="dim").append_text(place_text(node.exported, record.repository, links))
        yield text
    if node.node_name == ANONYMOUS:
        yield _field("name", "known only at run time, unless a launch file gives one")
    elif node.node_name and (node.node_name != node.name or node.node_namespace):
        yield _field("name", f"calls itself {join(node.node_namespace or '', node.node_name)}")
    yield Text.assemble(_field("declared", ""), place_text(node.location, record.repository, links))
    for bound in node.bounds:
        text = Text.assemble(_field("cut short", f"by the limit of {bound.limit} at "))
        yield text.append_text(place_text(bound.location, record.repository, links))
    others = [path for path in node.sources if path != node.location.path]
    if others:
        yield _field("sources", some(others, _MOST_SOURCES))


def _listed(classes: "Iterable[Class]") -> "Text":
    """Return classes, the weak ones dimmed."""
    return Text(", ").join(Text(str(one), "dim" if one.grade.grade == "weak" else "") for one in classes)


def _field(name: str, value: str) -> "Text":
    return Text.assemble((f"  {name:<9} ", "dim"), printable(value))


def _groups(node: NodeType, *, every: bool, via: bool) -> "list[tuple[str, list[Row]]]":
    groups: list[tuple[str, list[Row]]] = []
    for role in Role:
        chosen = [one for one in node.interfaces if one.role is role and (every or not one.implicit)]
        if chosen:
            chosen.sort(key=lambda one: one.implicit)
            rows = []
            for one in chosen:
                name = one.name if one.name is not None else NAME_UNKNOWN
                kind, calls = one.type or TYPE_UNKNOWN, one.via if via else ()
                rows.append(Row(name, kind, how(one), one.location, one.implicit, calls))
            groups.append((role.heading, rows))
    return groups


def _slot(fact: PluginSlot, record: "NodeRecord", *, via: bool) -> "Row":
    shown = []
    for one in fact.defaults:
        plugin = record.plugins.get(one.class_name)
        named = f"{one.name}: {one.class_name}" if one.name else one.class_name
        shown.append(f"{named} ({plugin[0].package}/{plugin[0].node})" if plugin is not None else named)
    remark, calls = f"= {', '.join(shown)}" if shown else "", fact.via if via else ()
    return Row(fact.base_class or VALUE_UNKNOWN, how_loaded(fact), remark, fact.location, dim=False, via=calls)


def _parameter(facts: "Sequence[Parameter]", *, via: bool) -> "Row":
    first = facts[0]
    default = next((one.default for one in facts if one.default is not None), None)
    kind = next((one.type for one in facts if one.type), "")
    reason = next((one.reason for one in facts if one.reason), "") if default is None or first.name is None else ""
    words = [f"= {default}" if default is not None else "", accesses(facts), reason]
    name = first.name if first.name is not None else NAME_UNKNOWN
    remark, calls = "  ".join(word for word in words if word), first.via if via else ()
    return Row(name, kind, remark, first.location, first.implicit, calls)
