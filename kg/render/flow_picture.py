"""A dependency picture as SVG: boxes from left to right, with labelled lines between them.

Boxes of a group have one colour and the group's name, so colours carry no extra meaning. A dashed line with a bar at
its end means that the box requires the absence of its input. The same input always gives the same bytes. Colours follow
`prefers-color-scheme`; `title` and `desc` describe the picture in words.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from kg.render.layered import Node, Rectangle, lay_out
from kg.render.svg import arrow, bar, before_tip, document, escaped, label, rounded, short
from kg.render.text import width

_MARGIN: Final = 20
_HEAD: Final = 74
_FOOT: Final = 40
_BOX_HIGH: Final = 44
_NAME_HIGH: Final = 24
_PORT: Final = 8
"""Height between two lines that end at one side of a box."""
_CHARACTER: Final = 7.9
_SMALL: Final = 6.7
_LONGEST: Final = 40
_KEY: Final = (
    "boxes are rules, rounded names what they derive for others; a dashed line with a bar: absence or counting"
)
_COLORS: Final = 8
"""Groups that the style distinguishes by colour."""


@dataclass(frozen=True, slots=True)
class Box:
    """A box with its name, its group, a sentence and a note; without a group it has a name only."""

    key: str
    name: str
    group: str = ""
    about: str = ""
    note: str = ""

    @property
    def below(self) -> str:
        """The text below the name."""
        return f"{self.group}, {self.note}" if self.note else self.group


@dataclass(frozen=True, slots=True)
class Flow:
    """A line between two boxes, by key; `absent`: the target requires the absence of the source."""

    source: str
    target: str
    absent: bool = False


def draw_flow(title: str, boxes: Sequence[Box], flows: Iterable[Flow]) -> str:
    """Return the SVG of boxes and the lines between them, `title` above; lines may form cycles."""
    every = sorted(set(flows), key=lambda flow: (flow.source, flow.target, flow.absent))
    groups = {group: number % _COLORS for number, group in enumerate(sorted({box.group for box in boxes if box.group}))}
    places = lay_out(_nodes(boxes, every), [(flow.source, flow.target) for flow in every])
    wide = int(max(places.wide, width(title) * 10.3, width(_KEY) * _SMALL) + 2 * _MARGIN)
    high = int(_HEAD + places.high + _FOOT)
    by_key = {box.key: box for box in boxes}
    drawn = [
        f'<text class="title" x="{_MARGIN}" y="32">{escaped(title)}</text>',
        f'<text class="key" x="{_MARGIN}" y="52">{escaped(_KEY)}</text>',
        f'<g transform="translate({_MARGIN} {_HEAD})">',
        *(_draw_flow(flow, by_key, way) for flow, way in zip(every, places.ways, strict=True)),
        *(line for box in boxes for line in _draw_box(box, places.boxes[box.key], groups)),
        "</g>",
    ]
    return document("flow", (wide, high), title, _description(by_key, every), drawn)


def _nodes(boxes: Sequence[Box], flows: Sequence[Flow]) -> list[Node]:
    """Return the boxes to be placed, high enough for the lines that end at either side."""
    into, out = Counter(flow.target for flow in flows), Counter(flow.source for flow in flows)
    nodes = []
    for box in boxes:
        name, below = width(short(box.name, _LONGEST)), width(short(box.below, _LONGEST))
        wide = int(max(name * _CHARACTER, below * _SMALL)) + 34 if box.group else int(name * 7.3) + 24
        high = max(_BOX_HIGH if box.group else _NAME_HIGH, _PORT * max(into[box.key], out[box.key]) + 8)
        nodes.append(Node(box.key, wide, high))
    return nodes


def _draw_box(box: Box, where: Rectangle, groups: Mapping[str, int]) -> Iterable[str]:
    x, y, middle = where.x, where.y, where.y + where.high / 2
    place = f'x="{x:g}" y="{y:g}" width="{where.wide:g}" height="{where.high:g}"'
    yield f"<g><title>{escaped(box.about or box.name)}</title>"
    if not box.group:
        yield f'<rect class="passed" {place} rx="12"/>'
        yield label("term", x + where.wide / 2, middle + 4, box.name, "middle", _LONGEST) + "</g>"
        return
    yield f'<rect class="box" {place} rx="5"/>'
    yield f'<rect class="mark g{groups[box.group]}" x="{x:g}" y="{y:g}" width="8" height="{where.high:g}" rx="3"/>'
    yield label("name", x + 18, middle - 2, box.name, longest=_LONGEST)
    yield label("sub", x + 18, middle + 14, box.below, longest=_LONGEST) + "</g>"


def _draw_flow(flow: Flow, boxes: Mapping[str, Box], points: Sequence[tuple[float, float]]) -> str:
    source, target = boxes[flow.source], boxes[flow.target]
    about = f"{target.name} {'asks for the absence of' if flow.absent else 'reads'} {source.name}"
    if source.group:
        about = f"{source.name} derives {target.name}"
    style, end, head = ("way absent", "bar", bar(points)) if flow.absent else ("way", "head", arrow(points))
    line = rounded(before_tip(points))
    return f'<g><title>{escaped(about)}</title><path class="{style}" d="{line}"/><path class="{end}" d="{head}"/></g>'


def _description(boxes: Mapping[str, Box], flows: Sequence[Flow]) -> str:
    """Return in words, box by box, what each one derives and reads."""
    sentences = []
    for box in (box for box in boxes.values() if box.group):
        makes = [boxes[flow.target].name for flow in flows if flow.source == box.key]
        reads = [boxes[flow.source].name for flow in flows if flow.target == box.key and not flow.absent]
        lacks = [boxes[flow.source].name for flow in flows if flow.target == box.key and flow.absent]
        phrases = [f"{verb} {', '.join(names)}" for verb, names in (("derives", makes), ("reads", reads)) if names]
        phrases += [f"asks for the absence of {', '.join(lacks)}"] if lacks else []
        sentences.append(f"{box.group}/{box.name}{' ' if phrases else ''}{', '.join(phrases)}.")
    return " ".join(sentences)
