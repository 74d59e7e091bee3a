"""The picture of a system as SVG: nodes and the channels between them, from outputs to inputs.

Channels between the same nodes share one box. A dangling end is a line in its node, with an arrow out of the node for
outputs, into it for inputs. Nodelets and components are inside the box of their host. `title` and `desc` describe the
picture in words. The same graph always gives the same bytes.

Nothing is told by colour alone: topics have round ends and solid lines, services square ends and dashed lines, actions
cut corners and thick lines; what is new has a `+`, what is gone a `-`, what changed a `~` before its name.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

from kg.render.layered import Node, Rectangle, lay_out
from kg.render.svg import arrow, before_tip, document, escaped, label, rounded, short
from kg.render.system_graph import SIGNS, Bundle, Channel, Link, Member, State, SystemGraph, bundles
from kg.render.text import width

_NAME: Final = 7.9
"""Width of a letter of a name, in pixels, as wide as those of generic monospace fonts get."""
_TERM: Final = 7.3
_SMALL: Final = 6.7


def _wide(text: str, letter: float) -> float:
    """Return how many pixels a text takes, shortened as it is shown."""
    return width(short(text)) * letter


def _outline(kind: str, x: float, y: float, w: float, h: float) -> str:
    """Return the path around a channel: round ends for a topic, cut corners for an action, square for a service."""
    if kind == "service":
        return f"M{x:g} {y:g}h{w:g}v{h:g}h{-w:g}z"
    if kind == "action":
        return f"M{x + 6:g} {y:g}h{w - 12:g}l6 6v{h - 12:g}l-6 6h{12 - w:g}l-6 -6v{12 - h:g}z"
    return f"M{x + 8:g} {y:g}h{w - 16:g}q8 0 8 8v{h - 16:g}q0 8 -8 8h{16 - w:g}q-8 0 -8 -8v{16 - h:g}q0 -8 8 -8z"


_MARGIN: Final = 24
_HEAD: Final = 82
_LINE: Final = 15
_PORT: Final = 8
"""Height between two lines that end at one side of a box."""
_MOST_LINES: Final = 6
_MOST_LOOSE: Final = ((12, 8), (30, 5), (10_000, 3))
"""How many ends that lead nowhere a node shows, by the number of nodes in the picture."""
_WORDS: Final = {"topic": "topic", "service": "service, from who calls it", "action": "action, from who calls it"}


@dataclass(frozen=True, slots=True)
class _Loose:
    """An end that leads nowhere, as a line in its node."""

    kind: str
    text: str
    about: str
    state: str


@dataclass(slots=True)
class _Drawing:
    """The layout: the members with their lines, and the bundles that have both sides."""

    graph: SystemGraph
    loose: dict[str, list[_Loose]] = field(init=False)
    joining: list[Bundle] = field(init=False)
    most: int = field(init=False)
    hosts: set[str] = field(init=False)

    def __post_init__(self) -> None:
        self.loose = {member.key: [] for member in self.graph.members}
        self.joining = []
        self.hosts = {member.host for member in self.graph.members if member.host}
        self.most = next(most for size, most in _MOST_LOOSE if len(self.graph.members) <= size)
        conditions = {(link.member, link.channel): link.condition for link in self.graph.links}
        for bundle in bundles(self.graph):
            if not bundle.dangling:
                self.joining.append(bundle)
                continue
            for member in sorted({*bundle.sources, *bundle.targets}):
                self.loose[member] += [
                    _loose(bundle, channel, member, conditions[member, channel.key]) for channel in bundle.channels
                ]

    def lines(self, member: Member) -> list[_Loose]:
        """Return the lines of a member, what changed first, cut where they are many."""
        every = sorted(self.loose[member.key], key=lambda one: (one.state == State.SAME, one.text[0] == "?"))
        if len(every) <= self.most:
            return every
        hidden = every[self.most - 1 :]
        way = "--expand" if member.kind == "namespace" else "kg node"
        about = "; ".join(one.about for one in hidden)
        more = _Loose("", f"+ {len(hidden)} more; {way} shows them", about, State.SAME)
        return [*every[: self.most - 1], more]

    def nodes(self) -> list[Node]:
        """Return the boxes to be placed: hosts, what lies in them, and channels."""
        nodes = []
        for member in self.graph.members:
            # The layout enlarges a host to hold its content, so its own size is a minimum.
            across, down = (60.0, 40.0) if member.key in self.hosts else self.size(member)
            nodes.append(Node(member.key, across, down, member.host))
        hosts = {member.key: member.host for member in self.graph.members}
        for bundle in self.joining:
            lines = _bundle_lines(bundle)
            across = round(max(_wide(line, _TERM) for line in lines)) + 26
            down = max(9 + _LINE * len(lines), _PORT * max(len(bundle.sources), len(bundle.targets)) + 8)
            around = {hosts[member] for member in (*bundle.sources, *bundle.targets)}
            nodes.append(Node(bundle.key, across, down, around.pop() if len(around) == 1 else None))
        return nodes

    def spread(self) -> list[tuple[str, str]]:
        """Return links that are not drawn, which put those of a host that are joined to nothing side by side."""
        joined = {member for bundle in self.joining for member in (*bundle.sources, *bundle.targets)}
        alone: dict[str, list[str]] = {}
        for member in self.graph.members:
            if member.host and member.key not in joined:
                alone.setdefault(member.host, []).append(member.key)
        return [
            pair for inside in alone.values() for pair in zip(inside, inside[math.isqrt(len(inside)) :], strict=False)
        ]

    def size(self, member: Member) -> tuple[float, float]:
        """Return the width and height of a member's box."""
        lines = self.lines(member)
        texts = [(_title(member), _NAME), *((one, _SMALL) for one in _under(member))]
        texts += [(one.text, _SMALL) for one in lines]
        room = max(_wide(text, letter) for text, letter in texts)
        return round(room) + 28, 26 + _LINE * (len(_under(member)) + len(lines)) + (4 if lines else 0)

    def links(self) -> list[tuple[Bundle, str, bool]]:
        """Return the ways to be drawn: a bundle, a member at it, and whether the member gives."""
        return [
            (bundle, member, gives)
            for bundle in self.joining
            for gives, side in ((True, bundle.sources), (False, bundle.targets))
            for member in side
        ]


def system_svg(graph: SystemGraph) -> str:
    """Return the SVG of a system's graph."""
    drawing = _Drawing(graph)
    links = drawing.links()
    drawn = [(m, b.key) if gives else (b.key, m) for b, m, gives in links]
    places = lay_out(drawing.nodes(), [*drawn, *drawing.spread()])
    ways = sorted(
        zip(links, places.ways[: len(links)], strict=True), key=lambda one: (one[0][0].key, one[0][1], one[0][2])
    )
    ends = {(link.member, link.channel, link.outward): link for link in graph.links}
    legend, legend_wide = _legend(graph, drawing.joining)
    notes = f"Not shown: {', '.join(graph.hidden)}." if graph.hidden else ""
    across = max(places.wide, legend_wide, width(graph.title) * 10.3, width(notes) * _SMALL)
    size_x, size_y = int(across + 2 * _MARGIN), int(_HEAD + places.high + _MARGIN + (22 if notes else 0))
    compared = bool(graph.states())
    lines = [
        f'<text class="title" x="{_MARGIN}" y="34">{escaped(graph.title)}</text>',
        *legend,
        f'<g transform="translate({_MARGIN} {_HEAD})">',
        *(_host(one, places.boxes[one.key]) for one in graph.members if one.key in drawing.hosts),
        *(
            _way(b, [ends[m, one.key, gives] for one in b.channels], points, compared=compared)
            for (b, m, gives), points in ways
        ),
        *(line for b in drawing.joining for line in _bundle(b, places.boxes[b.key])),
        *(
            line
            for one in graph.members
            if one.key not in drawing.hosts
            for line in _member(one, places.boxes[one.key], drawing.lines(one))
        ),
        "</g>",
        *([f'<text class="key" x="{_MARGIN}" y="{size_y - 14}">{escaped(notes)}</text>'] if notes else []),
    ]
    return document("system", (size_x, size_y), graph.title, _description(graph), lines)


def _loose(bundle: Bundle, channel: Channel, member: str, condition: str) -> _Loose:
    gives, takes = member in bundle.sources, member in bundle.targets
    arrow = "↺" if gives and takes else "→" if gives else "←"
    if channel.open:
        return _Loose(bundle.kind, f"{arrow} ? {channel.name}", f"the name {channel.name} is not known", channel.state)
    about = {
        "↺": f"only the node itself uses {channel.name}",
        "→": f"no subscriber for {channel.name}",
        "←": f"no publisher of {channel.name}",
    }
    sentence = ", ".join(filter(None, [about[arrow], condition]))
    return _Loose(bundle.kind, f"{SIGNS[channel.state]}{arrow} {channel.name}", sentence, channel.state)


def _title(member: Member) -> str:
    return SIGNS[member.state] + (f"{member.name.removesuffix('*')} …" if member.kind == "namespace" else member.name)


def _under(member: Member) -> list[str]:
    """Return the lines below the name: type and kind, and the condition."""
    what = [member.about or "?"] + ([member.kind] if member.kind not in {"node", "namespace"} else [])
    return [", ".join(what), *([f"if {member.condition}"] if member.condition else [])]


def _member(member: Member, where: Rectangle, lines: Sequence[_Loose]) -> Iterable[str]:
    style = " ".join(filter(None, ["many" if member.kind == "namespace" else "box", member.state]))
    unknown = " unknown" if member.reason or member.condition else ""
    x, y = where.x, where.y
    about = ". ".join(filter(None, [member.name, member.about, member.place, member.reason]))
    yield f"<g><title>{escaped(about)}</title>"
    yield f'<rect class="{style}{unknown}" x="{x:g}" y="{y:g}" width="{where.wide:g}" height="{where.high:g}" rx="5"/>'
    yield label("name", x + 12, y + 19, _title(member))
    base = y + 19
    for text in _under(member):
        base += _LINE
        yield label("sub", x + 12, base, text)
    base += 4
    for line in lines:
        base += _LINE
        yield f"<g><title>{escaped(line.about)}</title>{label('loose', x + 12, base, line.text)}</g>"
    yield "</g>"


def _host(member: Member, where: Rectangle) -> str:
    style = " ".join(filter(None, ["host", member.state, "unknown" if member.kind == "host" else ""]))
    about = ". ".join(filter(None, [member.name, member.about, member.place, member.reason]))
    return (
        f"<g><title>{escaped(about)}</title>"
        f'<rect class="{style}" x="{where.x:g}" y="{where.y:g}" width="{where.wide:g}" height="{where.high:g}" rx="8"/>'
        f"{label('sub', where.x + 12, where.y + 18, _title(member))}</g>"
    )


def _bundle_lines(bundle: Bundle) -> list[str]:
    clashes = (f" ({len(one.types)} types!)" if len(one.types) > 1 else "" for one in bundle.channels)
    names = [f"{SIGNS[one.state]}{one.name}{clash}" for one, clash in zip(bundle.channels, clashes, strict=True)]
    return names if len(names) <= _MOST_LINES else [*names[: _MOST_LINES - 1], f"+ {len(names) - _MOST_LINES + 1} more"]


def _bundle(bundle: Bundle, where: Rectangle) -> Iterable[str]:
    state = bundle.channels[0].state
    title = "; ".join(f"{bundle.kind} {one.name} ({' and '.join(one.types) or '?'})" for one in bundle.channels)
    yield f"<g><title>{escaped(title)}</title>"
    path = _outline(bundle.kind, where.x, where.y, where.wide, where.high)
    yield f'<path class="{" ".join(filter(None, ["sign", bundle.kind, state]))}" d="{path}"/>'
    lines = _bundle_lines(bundle)
    top = where.y + (where.high - _LINE * len(lines)) / 2 + 11.5
    for number, line in enumerate(lines):
        yield label("term", where.x + where.wide / 2, top + _LINE * number, line, "middle")
    yield "</g>"


def _way(bundle: Bundle, links: Sequence[Link], points: Sequence[tuple[float, float]], *, compared: bool) -> str:
    """Return the line of one member's links to a bundle, with rounded corners and a head at its end.

    It is dotted if each of them depends on a condition that is not decided.
    """
    first = links[0]
    named = zip(bundle.channels, links, strict=True)
    names = ", ".join(f"{one.name} {link.condition}".strip() for one, link in named)
    about = f"{first.member} to {names}" if first.outward else f"{names} to {first.member}"
    perhaps = "perhaps" if all(link.condition for link in links) else ""
    style = " ".join(filter(None, [bundle.kind, perhaps, first.state or ("still" if compared else "")]))
    return (
        f"<g><title>{escaped(about)}</title>"
        f'<path class="way {style}" d="{rounded(before_tip(points))}"/>'
        f'<path class="head {style}" d="{arrow(points)}"/></g>'
    )


def _legend(graph: SystemGraph, joining: Iterable[Bundle]) -> tuple[list[str], float]:
    """Return the key of signs, and where it ends; `joining` are the bundles that lines are drawn to."""
    kinds = [kind for kind in _WORDS if any(channel.kind == kind for channel in graph.channels)]
    drawn, x = [], float(_MARGIN)
    for kind in kinds:
        drawn.append(f'<path class="sign {kind}" d="{_outline(kind, x, 48, 34, 18)}"/>')
        drawn.append(
            f'<path class="way {kind}" d="M{x + 34:g} 57h22"/><path class="head {kind}" d="M{x + 62:g} 57l-8 -4.5v9z"/>'
        )
        drawn.append(label("key", x + 68, 61, _WORDS[kind]))
        x += 68 + _wide(_WORDS[kind], _SMALL) + 22
    states = graph.states()
    words = ["→ no subscriber or server", "← no publisher or client"]
    if any(channel.open for channel in graph.channels):
        words.append("? name not known")
    if any(member.reason or member.condition for member in graph.members):
        words.append("dashed: what it does, or whether it starts, is not known")
    drawn_to = {channel.key for one in joining for channel in one.channels}
    if any(link.condition and link.channel in drawn_to for link in graph.links):
        words.append("dotted: only under a condition that is not decided")
    words += [f"{SIGNS[state]}{state}" for state in (State.NEW, State.GONE, State.CHANGED) if state in states]
    text = "   ".join(words)
    drawn.append(f'<text class="key" x="{x:g}" y="61" xml:space="preserve">{escaped(text)}</text>')
    return drawn, x + len(text) * _SMALL


def _description(graph: SystemGraph) -> str:
    """Return in words, member by member, what it gives and takes."""
    names = {channel.key: f"{channel.kind} {channel.name}" for channel in graph.channels}
    gives: dict[str, list[str]] = {member.key: [] for member in graph.members}
    takes: dict[str, list[str]] = {member.key: [] for member in graph.members}
    for link in graph.links:
        (gives if link.outward else takes)[link.member].append(names[link.channel])
    sentences = []
    for member in graph.members:
        ends = (("sends to", gives[member.key]), ("serves", takes[member.key]))
        phrases = [f"{verb} {', '.join(which)}" for verb, which in ends if which]
        state = f" ({member.state})" if member.state else ""
        sentences.append(f"{member.name}{state}{' ' if phrases else ''}{' and '.join(phrases)}.")
    return " ".join([*sentences, *(f"Not shown: {one}." for one in graph.hidden)])
