"""One instance for people: the line that starts it, what it is set to, and its ends with the names that they have."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.cli.interface_table import Row, interface_table
from kg.render.text import printable
from kg.views.wording import TITLES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import RenderableType
    from rich.text import Text

    from kg.cli.links import Links
    from kg.facts import InstanceInterface, Location, NodeInstance, System

_UNKNOWN: Final = "(not known)"


def instance_view(
    system: System, instance: NodeInstance, links: Links, columns: int, *, every: bool
) -> tuple[RenderableType, ...]:
    """Return what to show of an instance on so many columns; `every` adds the ends that frameworks make."""
    from rich.text import Text  # noqa: PLC0415 - start-up time

    repository = system.configuration.repository
    groups = [
        (
            title,
            [_end(one, repository) for one in instance.interfaces if one.declared.role is role and _shown(one, every)],
        )
        for role, title in TITLES.items()
    ]
    remaps = [
        Row(one.source, one.target, "" if one.used else "changes nothing", one.remap.location, dim=False)
        for one in instance.remaps
    ]
    settings = [_setting(one.name, one.set.value, one.set.reason, one.set.location) for one in instance.parameters]
    groups += [("remappings, from and to", remaps), ("parameters", settings)]
    told = [(title, rows) for title, rows in groups if rows]
    parts: list[RenderableType] = list(_header(system, instance))
    if told:
        parts += [Text(), interface_table(told, repository, links, columns)]
    return tuple(parts)


def _shown(end: InstanceInterface, every: bool) -> bool:  # noqa: FBT001 - a filter
    return every or not end.declared.implicit


def _header(system: System, instance: NodeInstance) -> Iterator[Text]:
    from rich.text import Text  # noqa: PLC0415 - start-up time

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


def _end(end: InstanceInterface, repository: str) -> Row:
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


def _setting(name: str, value: str | None, reason: str | None, location: Location) -> Row:
    return Row(name, _UNKNOWN if value is None else value, reason or "", location, dim=False)
