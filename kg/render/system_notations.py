"""A system's graph in words, and for other programs: DOT of Graphviz, Mermaid, and plain values for JSON.

Both drawings have a node for each instance and each channel that has both sides or several; nothing in a name can leave
its place in the notation.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from kg.render.system_graph import SIGNS, Channel, Link, Member, State, SystemGraph
from kg.render.text import NAME_UNKNOWN, printable

_VERBS: Final = {
    ("topic", True): "publishes",
    ("topic", False): "subscribes",
    ("service", True): "calls",
    ("service", False): "offers",
    ("action", True): "calls action",
    ("action", False): "offers action",
}
NOBODY: Final = {
    ("topic", True): "nobody subscribes",
    ("topic", False): "nobody publishes",
    ("service", True): "nobody offers",
    ("service", False): "nobody calls",
    ("action", True): "nobody offers",
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
    """What is lacking where `others` is empty; `name not known` where nothing is known of them."""
    outward: bool = True
    state: str = ""
    condition: str = ""


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
                name=_channel_text(channel),
                type=" | ".join(channel.types),
                others=others,
                nobody="" if others else nobody_at(channel, outward=link.outward),
                outward=link.outward,
                state=link.state or channel.state,
                condition=link.condition,
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
    return NAME_UNKNOWN.strip("()") if channel.open else NOBODY[channel.kind, outward]


def _head(member: Member) -> str:
    kind = {"node": "", "inner": "further node of its program"}.get(member.kind, member.kind)
    parts = [member.about, kind, f"in {member.host}" if member.host else ""]
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
        doubt = f", {row.condition}" if row.condition else ""
        yield printable(
            f"  {SIGNS[row.state]}{arrow} {verb} {row.name.ljust(names)}  {row.type.ljust(types)}  {others}{doubt}"
        )


_DOT_STYLES: Final = {"topic": "shape=box, style=rounded", "service": "shape=box", "action": "shape=hexagon"}
_DOT_LINES: Final = {"topic": "", "service": ", style=dashed", "action": ", penwidth=2"}
_DOT_COLORS: Final = {State.NEW: "#14743c", State.GONE: "#b3261e", State.CHANGED: "#8a5a00"}
_MERMAID_SHAPES: Final = {"topic": ("([", "])"), "service": ("[", "]"), "action": ("{{", "}}")}
_MERMAID_LINES: Final = {"topic": "-->", "service": "-.->", "action": "==>"}
_MERMAID_STYLES: Final = (
    "classDef new stroke:#14743c,stroke-width:3px",
    "classDef gone stroke:#b3261e,stroke-width:3px,stroke-dasharray:4",
    "classDef changed stroke:#8a5a00,stroke-width:3px",
    "classDef unknown stroke-dasharray:5 4",
)


def system_dot(graph: SystemGraph) -> str:
    """Return the graph in the language of Graphviz; hosts are clusters, with themselves as a node inside."""
    ids = _ids(graph)
    kinds = {channel.key: channel for channel in graph.channels}
    lines = [
        f"digraph {_dot(graph.title)} {{",
        "  rankdir=LR;",
        '  node [fontname="monospace", fontsize=11];',
        f"  label={_dot(graph.title)};",
    ]
    for host, inside in _by_host(graph).items():
        if host is None:
            lines += [f"  {_dot_member(member, ids)}" for member in inside]
            continue
        lines += [f"  subgraph cluster_{ids[host]} {{", f"    label={_dot(host)};"]
        lines += [*(f"    {_dot_member(member, ids)}" for member in inside), "  }"]
    for channel in graph.channels:
        text = _dot(SIGNS[channel.state] + _channel_text(channel))
        lines.append(f"  {ids[channel.key]} [label={text}, {_DOT_STYLES[channel.kind]}{_dot_color(channel.state)}];")
    for link in graph.links:
        source, target = _ends(link)
        perhaps = f", style=dotted, label={_dot(link.condition)}" if link.condition else ""
        style = f"{perhaps or _DOT_LINES[kinds[link.channel].kind]}{_dot_color(link.state)}".lstrip(", ")
        lines.append(f"  {ids[source]} -> {ids[target]}{f' [{style}]' if style else ''};")
    return "\n".join([*lines, "}", ""])


def system_mermaid(graph: SystemGraph) -> str:
    """Return the graph as a flow chart of Mermaid; hosts are subgraphs, with themselves as a node inside."""
    ids = _ids(graph)
    kinds = {channel.key: channel.kind for channel in graph.channels}
    lines = ["flowchart LR"]
    for host, inside in _by_host(graph).items():
        nodes = [f"{ids[one.key]}[{_mermaid(SIGNS[one.state] + _member_text(one, '<br>'))}]" for one in inside]
        if host is None:
            lines += [f"  {node}" for node in nodes]
        else:
            lines += [f"  subgraph {ids[host]}_host[{_mermaid(host)}]", *(f"    {node}" for node in nodes), "  end"]
    for channel in graph.channels:
        before, behind = _MERMAID_SHAPES[channel.kind]
        text = _mermaid(SIGNS[channel.state] + _channel_text(channel))
        lines.append(f"  {ids[channel.key]}{before}{text}{behind}")
    for link in graph.links:
        source, target = _ends(link)
        perhaps = f"|{_mermaid(link.condition)}|" if link.condition else ""
        lines.append(f"  {ids[source]} {_MERMAID_LINES[kinds[link.channel]]}{perhaps} {ids[target]}")
    marked = [f"  class {ids[one.key]} {one.state}" for one in graph.members if one.state]
    marked += [f"  class {ids[one.key]} {one.state}" for one in graph.channels if one.state]
    marked += [f"  class {ids[one.key]} unknown" for one in graph.members if _unknown(one) and not one.state]
    marked += [f"  class {ids[one.key]} unknown" for one in graph.channels if one.open and not one.state]
    return "\n".join([*lines, *(f"  {style}" for style in _MERMAID_STYLES if marked), *marked, ""])


def system_object(graph: SystemGraph) -> dict[str, Any]:
    """Return the graph as plain values, ready for JSON; the fields of docs/formats.md."""
    ends = graph.ends()
    return {
        "title": graph.title,
        "nodes": [
            {
                "id": member.key,
                "name": member.name,
                "kind": member.kind,
                "type": member.about or None,
                "host": member.host,
                "count": member.count,
                "condition": member.condition,
                "reason": member.reason,
                "place": member.place or None,
                **_state(member.state),
            }
            for member in graph.members
        ],
        "channels": [
            {
                "id": channel.key,
                "kind": channel.kind,
                "name": channel.name,
                "types": list(channel.types),
                "known": not channel.open,
                "dangling": not channel.open and not all(ends[channel.key]),
                **_state(channel.state),
            }
            for channel in graph.channels
        ],
        "edges": [
            {
                **dict(zip(("source", "target"), _ends(link), strict=True)),
                **_state(link.state),
                **({"condition": link.condition} if link.condition else {}),
            }
            for link in graph.links
        ],
        "hidden": list(graph.hidden),
    }


def _state(state: str) -> dict[str, str]:
    return {"state": state} if state else {}


def _ends(link: Link) -> tuple[str, str]:
    return (link.member, link.channel) if link.outward else (link.channel, link.member)


def _ids(graph: SystemGraph) -> dict[str, str]:
    """Return short names for everything that is drawn, the same for the same graph."""
    members = {member.key: f"n{number}" for number, member in enumerate(graph.members)}
    return {**members, **{channel.key: f"c{number}" for number, channel in enumerate(graph.channels)}}


def _by_host(graph: SystemGraph) -> Mapping[str | None, list[Member]]:
    """Return the members by the host that they share, hosts among those inside of them."""
    hosts = {member.host for member in graph.members if member.host}
    members: dict[str | None, list[Member]] = {None: []}
    for member in graph.members:
        members.setdefault(member.key if member.key in hosts else member.host, []).append(member)
    return members


def _unknown(member: Member) -> bool:
    return bool(member.reason or member.condition)


def _member_text(member: Member, new_line: str) -> str:
    return f"{member.name}{new_line}{member.about}" if member.about else member.name


def _channel_text(channel: Channel) -> str:
    return f"? {channel.name}" if channel.open else channel.name


def _dot_member(member: Member, ids: Mapping[str, str]) -> str:
    style = '"filled,dashed"' if _unknown(member) else "filled"
    text = _dot(SIGNS[member.state] + _member_text(member, "\n"))
    return f'{ids[member.key]} [label={text}, shape=box, style={style}, fillcolor="#eef3f8"{_dot_color(member.state)}];'


def _dot_color(state: str) -> str:
    return f', color="{_DOT_COLORS[state]}"' if state else ""


def _dot(text: str) -> str:
    """Return a quoted string of DOT; a line break becomes one of the label."""
    lines = [printable(line).replace("\\", "\\\\").replace('"', '\\"') for line in text.split("\n")]
    return '"' + "\\n".join(lines) + '"'


def _mermaid(text: str) -> str:
    """Return a quoted label of Mermaid; signs with a meaning in it are written as their numbers."""
    parts = [
        "".join(sign if sign.isalnum() or sign in " /_.,:-+~?" else f"#{ord(sign)};" for sign in printable(part))
        for part in text.split("<br>")
    ]
    return f'"{"<br>".join(parts)}"'
