"""One node for people: what it is, how to start it, and its interface by role with the line of each entry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.cli.interface_table import Row, interface_table, place_text
from kg.facts import NodeKind, NodeType, Parameter, PluginSlot, Role
from kg.graph.reading.classes import Class, Classes
from kg.graph.records import how_to_start
from kg.lazily import lazily
from kg.render.text import count, printable, some
from kg.views.wording import LANGUAGES, accesses, how, how_loaded, parameter_groups, quoted

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rich.console import RenderableType

    from kg.cli.links import Links
    from kg.graph.reading.nodes import NodeRecord
    from kg.views.evidence import Places

with lazily():
    from rich.padding import Padding
    from rich.text import Text

_MOST_DESCRIPTIONS: Final = 2  # maximum number of descriptions shown by default; the best come first
_MOST_SOURCES: Final = 4
_NO_CLASSES: Final = Classes()


def node_view(  # noqa: PLR0913 - what is shown, and how much of it
    record: NodeRecord,
    links: Links,
    columns: int,
    *,
    every: bool,
    via: bool = False,
    most: int | None = None,
    classes: Classes = _NO_CLASSES,
) -> tuple[RenderableType, ...]:
    """Return the output for a node at a width in columns; `every` adds the endpoints of frameworks.

    `via` adds the calls from a line of the node's package to the framework, if they are in other files. `most` limits
    the number of parameters, so a terminal still shows the interface. `classes` is the result of rules.

    If lines are too narrow for whole paths, their beginnings are cut; the links still lead to the file.
    """
    parts: list[RenderableType] = list(_header(record, links))
    parts.append(Text.assemble(_field("function", ""), _listed(classes.functions) if classes.functions else "unknown"))
    if classes.hardware or classes.devices:
        parts.append(Text.assemble(_field("hardware", ""), _listed((*classes.hardware, *classes.devices))))
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
    return tuple(parts)


def node_lines(record: NodeRecord, where: Places, *, every: bool) -> tuple[Text, ...]:
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


def _header(record: NodeRecord, links: Links) -> Iterable[Text]:
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
    if node.node_name and node.node_name != node.name:
        yield _field("name", f"calls itself {node.node_name}")
    yield Text.assemble(_field("declared", ""), place_text(node.location, record.repository, links))
    for bound in node.bounds:
        text = Text.assemble(_field("cut short", f"by the limit of {bound.limit} at "))
        yield text.append_text(place_text(bound.location, record.repository, links))
    others = [path for path in node.sources if path != node.location.path]
    if others:
        yield _field("sources", some(others, _MOST_SOURCES))


def _listed(classes: Iterable[Class]) -> Text:
    """Return classes, the weak ones dimmed."""
    return Text(", ").join(Text(str(one), "dim" if one.grade.grade == "weak" else "") for one in classes)


def _field(name: str, value: str) -> Text:
    return Text.assemble((f"  {name:<9} ", "dim"), printable(value))


def _groups(node: NodeType, *, every: bool, via: bool) -> list[tuple[str, list[Row]]]:
    groups: list[tuple[str, list[Row]]] = []
    for role in Role:
        chosen = [one for one in node.interfaces if one.role is role and (every or not one.implicit)]
        if chosen:
            chosen.sort(key=lambda one: one.implicit)
            rows = []
            for one in chosen:
                name = one.name if one.name is not None else "(not resolved)"
                kind, calls = one.type or "(type not known)", one.via if via else ()
                rows.append(Row(name, kind, how(one), one.location, one.implicit, calls))
            groups.append((role.heading, rows))
    return groups


def _slot(fact: PluginSlot, record: NodeRecord, *, via: bool) -> Row:
    shown = []
    for one in fact.defaults:
        plugin = record.plugins.get(one.class_name)
        named = f"{one.name}: {one.class_name}" if one.name else one.class_name
        shown.append(f"{named} ({plugin[0].package}/{plugin[0].node})" if plugin is not None else named)
    remark, calls = f"= {', '.join(shown)}" if shown else "", fact.via if via else ()
    return Row(fact.base_class or "(not known)", how_loaded(fact), remark, fact.location, dim=False, via=calls)


def _parameter(facts: Sequence[Parameter], *, via: bool) -> Row:
    first = facts[0]
    default = next((one.default for one in facts if one.default is not None), None)
    kind = next((one.type for one in facts if one.type), "")
    words = [f"= {default}" if default is not None else "", accesses(facts)]
    name = first.name if first.name is not None else "(not resolved)"
    remark, calls = "  ".join(word for word in words if word), first.via if via else ()
    return Row(name, kind, remark, first.location, first.implicit, calls)
