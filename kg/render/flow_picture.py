"""A picture of what feeds what, as SVG: boxes from left to right, and between them the names of what passes on.

Boxes of a group have one colour and name the group, so that nothing is told by colour alone; a dashed line with a bar
at its end says that the box asks for what is absent. The same input always gives the same bytes. Colours follow
`prefers-color-scheme`; `title` and `desc` say the same in words.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.render.layered import Node, Rectangle, lay_out
from kg.render.svg import ROLE, arrow, bar, before_tip, dimensions, escaped, label, rounded, short
from kg.render.text import width

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


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
_COLORS: Final = 8
_LIGHT: Final = ("#1f6f43", "#8a4b08", "#6b3fa0", "#0b5c8a", "#9c2f4f", "#4d5f14", "#5a4a8f", "#7a4a36")
_DARK: Final = ("#6fcf97", "#f2b26b", "#c39bf0", "#7cc4ee", "#f29bb5", "#c3d46b", "#b0a4ee", "#e0ab94")
_STYLE: Final = """
svg { background: #ffffff; font-family: ui-monospace, SFMono-Regular, Menlo, Consolas, "DejaVu Sans Mono", monospace; }
.box { fill: #eef3f8; stroke: #34495e; stroke-width: 1.5; } .mark { stroke: none; }
.passed { fill: #ffffff; stroke: #7b8a99; stroke-width: 1; }
.way { fill: none; stroke: #6d7f90; stroke-width: 1.5; } .absent { stroke-dasharray: 6 4; stroke: #a3341f; }
.head { fill: #6d7f90; stroke: none; } .bar { fill: none; stroke: #a3341f; stroke-width: 3; }
.title { font-size: 17px; font-weight: bold; fill: #17202a; }
.name { font-size: 13px; font-weight: bold; fill: #17202a; }
.sub, .key { font-size: 11px; fill: #4d5a66; } .term { font-size: 12px; fill: #17202a; }
"""
_DARK_STYLE: Final = """@media (prefers-color-scheme: dark) {
svg { background: #14191f; } .box { fill: #1f2933; stroke: #9fb3c8; } .passed { fill: #14191f; stroke: #8b9cad; }
.way { stroke: #8b9cad; } .absent { stroke: #ff8f7a; } .head { fill: #8b9cad; } .bar { stroke: #ff8f7a; }
.title, .name, .term { fill: #f0f4f8; } .sub, .key { fill: #b3c0cc; }
"""


@dataclass(frozen=True, slots=True)
class Box:
    """A box with its name, its group, a sentence about it and a note beside its group; without group a name only."""

    key: str
    name: str
    group: str = ""
    about: str = ""
    note: str = ""

    @property
    def below(self) -> str:
        """What stands below the name."""
        return f"{self.group}, {self.note}" if self.note else self.group


@dataclass(frozen=True, slots=True)
class Flow:
    """A line from one thing to another, by key; `absent`: the target asks for what is not there."""

    source: str
    target: str
    absent: bool = False


def draw_flow(title: str, boxes: Sequence[Box], flows: Iterable[Flow]) -> str:
    """Return the SVG of boxes and the lines between them, `title` above; lines may form cycles."""
    every = sorted(set(flows), key=lambda flow: (flow.source, flow.target, flow.absent))
    groups = {group: number % _COLORS for number, group in enumerate(sorted({box.group for box in boxes if box.group}))}
    places = lay_out(_nodes(boxes, every), [(flow.source, flow.target) for flow in every])
    wide = int(max(places.wide, width(title) * 10.3, width(_key_of_signs()) * _SMALL) + 2 * _MARGIN)
    high = int(_HEAD + places.high + _FOOT)
    known = {box.key: box for box in boxes}
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {dimensions(wide, high)} {ROLE}>',
        f'<title id="title">{escaped(title)}</title>',
        f'<desc id="desc">{escaped(_description(known, every))}</desc>',
        f"<style>{_STYLE}{_colors(_LIGHT)}{_DARK_STYLE}{_colors(_DARK)}}}</style>",
        f'<text class="title" x="{_MARGIN}" y="32">{escaped(title)}</text>',
        f'<text class="key" x="{_MARGIN}" y="52">{escaped(_key_of_signs())}</text>',
        f'<g transform="translate({_MARGIN} {_HEAD})">',
        *(_draw_flow(flow, known, way) for flow, way in zip(every, places.ways, strict=True)),
        *(line for box in boxes for line in _draw_box(box, places.boxes[box.key], groups)),
        "</g>",
    ]
    return "\n".join([*parts, "</svg>", ""])


def _key_of_signs() -> str:
    return "boxes are rules, rounded names what they derive for others; a dashed line with a bar: absence or counting"


def _colors(colors: Sequence[str]) -> str:
    return "".join(f".g{number} {{ fill: {color}; }} " for number, color in enumerate(colors)) + "\n"


def _nodes(boxes: Sequence[Box], flows: Sequence[Flow]) -> list[Node]:
    """Return the boxes to be placed, high enough for the lines that end at either side."""
    into, out = Counter(flow.target for flow in flows), Counter(flow.source for flow in flows)
    return [
        Node(
            box.key,
            _wide(box),
            max(_BOX_HIGH if box.group else _NAME_HIGH, _PORT * max(into[box.key], out[box.key]) + 8),
        )
        for box in boxes
    ]


def _wide(box: Box) -> float:
    if not box.group:
        return int(width(short(box.name, _LONGEST)) * 7.3) + 24
    return int(max(width(short(box.name, _LONGEST)) * _CHARACTER, width(short(box.below, _LONGEST)) * _SMALL)) + 34


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
        told = [f"{verb} {', '.join(names)}" for verb, names in (("derives", makes), ("reads", reads)) if names]
        told += [f"asks for the absence of {', '.join(lacks)}"] if lacks else []
        sentences.append(f"{box.group}/{box.name}{' ' if told else ''}{', '.join(told)}.")
    return " ".join(sentences)
