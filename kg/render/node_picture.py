"""The picture of one node as SVG, drawn like a chip: inputs on the left, outputs on the right.

Topics have round ends and solid wires, services square ones and dashed wires, actions cut corners and thick wires, so
colours carry no extra meaning. The same node always gives the same bytes. Colours follow `prefers-color-scheme`;
`title` and `desc` describe the picture in words.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from kg.facts import Role
from kg.render.svg import document, escaped, label, short
from kg.render.text import width

_LEFT: Final = ("subscribes", "services", "action_servers")
_RIGHT: Final = ("publishes", "clients", "action_clients")
_ROW: Final = 40
_HEADING: Final = 30
_WIRE: Final = 64
_MARGIN: Final = 16
_HEAD: Final = 64
_CHARACTER: Final = 7.85
_SMALL: Final = 6.65
_LONGEST: Final = 44
_LONGEST_LINE: Final = 72


@dataclass(frozen=True, slots=True)
class Port:
    """One end of a topic, service or action; `role` is a value of `kg.facts.Role`."""

    role: str
    name: str
    type: str
    implicit: bool = False


@dataclass(frozen=True, slots=True)
class _Side:
    groups: tuple[tuple[str, tuple[Port, ...]], ...]

    @property
    def height(self) -> int:
        return sum(_HEADING + _ROW * len(ports) for _, ports in self.groups)

    @property
    def label_width(self) -> int:
        widths = [
            int(width(short(text, _LONGEST)) * size) + 34
            for _, ports in self.groups
            for port in ports
            for text, size in ((port.name, _CHARACTER), (port.type, _SMALL))
        ]
        headings = [width(Role(role).heading) * 7 for role, _ in self.groups]
        return max(*widths, *headings, 0, 0)


def draw(title: str, lines: Sequence[str], ports: Iterable[Port], *, more: str = "") -> str:
    """Return the SVG of a node: `lines` are below its name, `more` describes what is not shown."""
    every = sorted(ports, key=lambda port: (port.implicit, port.name, port.type))
    left, right = _side(_LEFT, every), _side(_RIGHT, every)
    texts = [(title, 10.3), *((line, 7.3) for line in lines), (more, 7.3)]
    box = int(max(200, *(width(short(text, _LONGEST_LINE)) * size + 40 for text, size in texts)))
    head = _HEAD + 17 * max(0, len(lines) - 1)
    height = head + max(left.height, right.height, _ROW) + (34 if more else 12)
    box_x = _MARGIN + (left.label_width + _WIRE if left.groups else 0)
    whole = box_x + box + (right.label_width + _WIRE if right.groups else 0) + _MARGIN
    middle = box_x + box / 2
    drawn = [
        f'<rect class="box" x="{box_x}" y="{_MARGIN}" width="{box}" height="{height}" rx="10"/>',
        label("title", middle, _MARGIN + 28, title, "middle", _LONGEST_LINE),
        *(
            label("sub", middle, _MARGIN + 48 + 17 * number, line, "middle", _LONGEST_LINE)
            for number, line in enumerate(lines)
        ),
        *_draw_side(left, _MARGIN + head, outer=_MARGIN, inner=box_x, inward=True),
        *_draw_side(right, _MARGIN + head, outer=whole - _MARGIN, inner=box_x + box, inward=False),
    ]
    if more:
        drawn.append(label("more", middle, _MARGIN + height - 12, more, "middle", _LONGEST_LINE))
    return document("node", (whole, height + 2 * _MARGIN), f"Node {title}", _description(every, more), drawn)


def _side(roles: Sequence[str], ports: Sequence[Port]) -> _Side:
    groups = ((role, tuple(port for port in ports if port.role == role)) for role in roles)
    return _Side(tuple(group for group in groups if group[1]))


def _draw_side(side: _Side, top: int, *, outer: int, inner: int, inward: bool) -> Iterable[str]:
    """Yield one side from `top` down: labels start at x `outer`, wires end at `inner`, the edge of the box."""
    size = side.label_width
    x, wire = (outer, (outer + size, inner)) if inward else (outer - size, (inner, outer - size))
    anchor = "start" if inward else "end"
    y = top
    for role, ports in side.groups:
        yield f'<text class="group" x="{outer}" y="{y + 20}" text-anchor="{anchor}">{Role(role).heading}</text>'
        y += _HEADING
        for port in ports:
            yield from _draw_port(port, x, y + _ROW // 2 - 2, size, wire)
            y += _ROW


def _draw_port(port: Port, x: int, y: int, size: int, wire: tuple[int, int]) -> Iterable[str]:
    """Yield a label from `x` on around the height `y`, and its wire, which always points to the right."""
    shape = Role(port.role).channel
    start, end = wire
    yield f'<g class="{"implicit" if port.implicit else "declared"}">'
    yield f"<title>{escaped(f'{Role(port.role).heading} {port.name} ({port.type})')}</title>"
    yield f'<path class="wire {shape}" d="M{start} {y}H{end - 6}"/>'
    yield f'<path class="head {shape}" d="M{end} {y}l-9 -6v12z"/>'
    yield f'<path class="port {shape}" d="{_outline(shape, x, y - 17, size, 34)}"/>'
    yield label("name", x + size / 2, y - 2, port.name, "middle", _LONGEST)
    yield label("type", x + size / 2, y + 12, port.type, "middle", _LONGEST) + "</g>"


def _outline(shape: str, x: int, y: int, w: int, h: int) -> str:
    if shape == "service":
        return f"M{x} {y}h{w}v{h}h{-w}z"
    if shape == "action":
        return f"M{x + 10} {y}h{w - 20}l10 10v{h - 20}l-10 10h{20 - w}l-10 -10v{20 - h}z"
    return f"M{x + 14} {y}h{w - 28}a14 17 0 0 1 0 {h}h{28 - w}a14 17 0 0 1 0 {-h}z"


def _description(ports: Sequence[Port], more: str) -> str:
    sentences = []
    for role in (*_LEFT, *_RIGHT):
        named = [f"{port.name} ({port.type})" for port in ports if port.role == role]
        if named:
            sentences.append(f"It {Role(role).heading} {', '.join(named)}.")
    return " ".join([*(sentences or ["It has no topics, services or actions."]), *([f"{more}."] if more else [])])
