"""A system in words: node by node what goes out and comes in, and where it leads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.render.system_style import SIGNS
from kg.render.text import printable

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.render.system_graph import Channel, Member, SystemGraph

_VERBS: Final = {
    ("topic", True): "publishes",
    ("topic", False): "subscribes",
    ("service", True): "calls",
    ("service", False): "serves",
    ("action", True): "calls action",
    ("action", False): "serves action",
}
NOBODY: Final = {
    ("topic", True): "nobody subscribes",
    ("topic", False): "nobody publishes",
    ("service", True): "nobody serves",
    ("service", False): "nobody calls",
    ("action", True): "nobody serves",
    ("action", False): "nobody calls",
}


@dataclass(frozen=True, slots=True)
class SystemRow:
    """One end: the node, what it does, the channel's name and types, and the nodes at the other side."""

    node: str
    verb: str
    name: str
    type: str
    others: tuple[str, ...]
    nobody: str = ""
    """What is lacking where `others` is empty; `name not known` where nothing can be said."""
    outward: bool = True
    state: str = ""


def system_rows(graph: SystemGraph) -> list[SystemRow]:
    """Return the ends of all nodes, node by node: what goes out, then what comes in."""
    ends = graph.ends()
    channels = {channel.key: channel for channel in graph.channels}
    links = sorted(graph.links, key=lambda one: (one.member, not one.outward, one.channel))
    rows = []
    for link in links:
        channel, others = channels[link.channel], ends[link.channel][link.outward]
        rows.append(
            SystemRow(
                node=link.member,
                verb=_VERBS[channel.kind, link.outward],
                name=channel.name,
                type=" | ".join(channel.types),
                others=others,
                nobody="" if others else nobody_at(channel, outward=link.outward),
                outward=link.outward,
                state=link.state or channel.state,
            )
        )
    return rows


def system_lines(graph: SystemGraph) -> list[str]:
    """Return lines for people: each node with its ends below it, and at the end what is not shown."""
    rows: dict[str, list[SystemRow]] = {member.key: [] for member in graph.members}
    for row in system_rows(graph):
        rows[row.node].append(row)
    lines: list[str] = []
    for member in graph.members:
        lines += [_head(member), *_below(rows[member.key]), ""]
    return [*lines, *([f"not shown: {', '.join(graph.hidden)}"] if graph.hidden else [])]


def nobody_at(channel: Channel, *, outward: bool) -> str:
    """Return what to say where nobody is at the other side of a channel."""
    return "name not known" if channel.open else NOBODY[channel.kind, outward]


def _head(member: Member) -> str:
    parts = [member.about, "" if member.kind == "node" else member.kind, f"in {member.host}" if member.host else ""]
    parts += [f"if {member.condition}" if member.condition else "", member.place]
    words = "  ".join(filter(None, [", ".join(filter(None, parts)), f"({member.reason})" if member.reason else ""]))
    return printable(f"{SIGNS[member.state]}{member.name}  {words}".rstrip())


def _below(rows: Iterable[SystemRow]) -> Iterable[str]:
    every = list(rows)
    names = max((len(row.name) for row in every), default=0)
    types = max((len(row.type) for row in every), default=0)
    for row in every:
        arrow = "→" if row.outward else "←"
        others = ", ".join(row.others) or f"({row.nobody})"
        verb = row.verb.ljust(13)
        yield printable(
            f"  {SIGNS[row.state]}{arrow} {verb} {row.name.ljust(names)}  {row.type.ljust(types)}  {others}"
        )
