"""A picture of what feeds what, as SVG: boxes in columns, and between them the names of what passes on.

Boxes of a group have one colour and name the group, so that nothing is told by colour alone; a dashed line with a bar
at its end says that the box asks for what is absent. The same input always gives the same bytes. Colours follow
`prefers-color-scheme`; `title` and `desc` say the same in words.
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Final

from kg.render.columns import Item, arrange
from kg.render.text import printable, width

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.render.columns import Placed

__all__ = ["Box", "Flow", "draw_flow"]

_MARGIN: Final = 20
_HEAD: Final = 74
_FOOT: Final = 40
_BOX_HIGH: Final = 44
_NAME_HIGH: Final = 24
_CHARACTER: Final = 7.9
_SMALL: Final = 6.7
_LONGEST: Final = 40
_BEND: Final = 42
_LOOP: Final = 7
"""How far below the way there the way back stands."""
_COLORS: Final = 8
_LIGHT: Final = ("#1f6f43", "#8a4b08", "#6b3fa0", "#0b5c8a", "#9c2f4f", "#4d5f14", "#5a4a8f", "#7a4a36")
_DARK: Final = ("#6fcf97", "#f2b26b", "#c39bf0", "#7cc4ee", "#f29bb5", "#c3d46b", "#b0a4ee", "#e0ab94")
_ROLE: Final = 'role="img" aria-labelledby="title desc"'
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
    """A box with its name, its group, a sentence about it and a note beside its group.

    Boxes stand in even columns, names in odd ones.
    """

    key: str
    column: int
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
    """Return the SVG of boxes and the lines between them, `title` above; a line may lead back to an earlier column."""
    every = sorted(set(flows), key=lambda flow: (flow.source, flow.target, flow.absent))
    groups = {group: number % _COLORS for number, group in enumerate(sorted({box.group for box in boxes if box.group}))}
    placed = arrange([_item(box) for box in boxes], [(flow.source, flow.target) for flow in every])
    wide = int(max(placed.wide, width(title) * 10.3, width(_key_of_signs()) * _SMALL) + 2 * _MARGIN)
    high = int(_HEAD + placed.high + _FOOT)
    known = {box.key: box for box in boxes}
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {_size(wide, high)} {_ROLE}>',
        f'<title id="title">{_text(title)}</title>',
        f'<desc id="desc">{_text(_description(known, every))}</desc>',
        f"<style>{_STYLE}{_colors(_LIGHT)}{_DARK_STYLE}{_colors(_DARK)}}}</style>",
        f'<text class="title" x="{_MARGIN}" y="32">{_text(title)}</text>',
        f'<text class="key" x="{_MARGIN}" y="52">{_text(_key_of_signs())}</text>',
        f'<g transform="translate({_MARGIN} {_HEAD})">',
        *(line for flow in every for line in _draw_flow(flow, known, placed)),
        *(line for box in boxes for line in _draw_box(box, placed.boxes[box.key], groups)),
        "</g>",
    ]
    return "\n".join([*parts, "</svg>", ""])


def _size(wide: int, high: int) -> str:
    return f'width="{wide}" height="{high}" viewBox="0 0 {wide} {high}"'


def _key_of_signs() -> str:
    return "boxes are rules, rounded names what they derive for others; a dashed line with a bar: absence or counting"


def _colors(colors: Sequence[str]) -> str:
    return "".join(f".g{number} {{ fill: {color}; }} " for number, color in enumerate(colors)) + "\n"


def _item(box: Box) -> Item:
    return Item(box.key, box.column, _wide(box), _BOX_HIGH if box.group else _NAME_HIGH)


def _wide(box: Box) -> float:
    if not box.group:
        return int(width(_short(box.name)) * 7.3) + 24
    return int(max(width(_short(box.name)) * _CHARACTER, width(_short(box.below)) * _SMALL)) + 34


def _draw_box(box: Box, where: tuple[float, float], groups: Mapping[str, int]) -> Iterable[str]:
    x, y = where
    wide = _wide(box)
    yield f"<g><title>{_text(box.about or box.name)}</title>"
    if not box.group:
        yield f'<rect class="passed" x="{x:g}" y="{y - 12:g}" width="{wide:g}" height="24" rx="12"/>'
        yield _label("term", x + wide / 2, y + 4, box.name, "middle") + "</g>"
        return
    top = y - _BOX_HIGH / 2
    yield f'<rect class="box" x="{x:g}" y="{top:g}" width="{wide:g}" height="{_BOX_HIGH}" rx="5"/>'
    yield f'<rect class="mark g{groups[box.group]}" x="{x:g}" y="{top:g}" width="8" height="{_BOX_HIGH}" rx="3"/>'
    yield _label("name", x + 18, y - 2, box.name)
    yield _label("sub", x + 18, y + 14, box.below) + "</g>"


def _draw_flow(flow: Flow, boxes: Mapping[str, Box], placed: Placed) -> Iterable[str]:
    """Yield a line from the right edge of the source to the left edge of the target, or back to the right edge."""
    style = "way absent" if flow.absent else "way"
    source, target = boxes[flow.source], boxes[flow.target]
    (from_x, from_y), (to_x, to_y) = placed.boxes[flow.source], placed.boxes[flow.target]
    about = f"{target.name} {'asks for the absence of' if flow.absent else 'reads'} {source.name}"
    if source.group:
        about = f"{source.name} derives {target.name}"
    yield f"<g><title>{_text(about)}</title>"
    if source.column >= target.column:
        end = to_x + _wide(target)
        yield f'<path class="{style}" d="{_curve([(from_x, from_y + _LOOP), (end, to_y + _LOOP)], -_BEND)}"/>'
        yield _end(end, to_y + _LOOP, 1, absent=flow.absent) + "</g>"
        return
    points = [(from_x + _wide(source), from_y), *placed.ways[flow.source, flow.target], (to_x, to_y)]
    yield f'<path class="{style}" d="{_curve(points, _BEND)}"/>'
    yield _end(to_x, to_y, -1, absent=flow.absent) + "</g>"


def _curve(points: Sequence[tuple[float, float]], bend: int) -> str:
    """Return a path that bends between the columns and is straight while it passes one."""
    (x, y), *rest = points
    path = f"M{x:g} {y:g}"
    for next_x, next_y in rest:
        path += (
            f"H{next_x:g}" if next_y == y else f"C{x + bend:g} {y:g} {next_x - bend:g} {next_y:g} {next_x:g} {next_y:g}"
        )
        x, y = next_x, next_y
    return path


def _end(x: float, y: float, side: int, *, absent: bool) -> str:
    if absent:
        return f'<path class="bar" d="M{x + 3 * side:g} {y - 7:g}v14"/>'
    return f'<path class="head" d="M{x:g} {y:g}l{8 * side} -5v10z"/>'


def _label(style: str, x: float, y: float, text: str, anchor: str = "start") -> str:
    return f'<text class="{style}" x="{x:g}" y="{y:g}" text-anchor="{anchor}">{_text(_short(text))}</text>'


def _short(text: str) -> str:
    """Return `text` with its middle left out when it is long; the whole stands in the title of its group."""
    safe = printable(text)
    half = _LONGEST // 2
    return safe if len(safe) <= _LONGEST else f"{safe[: half - 1]}…{safe[-half:]}"


def _text(text: str) -> str:
    return escape(printable(text), quote=True)


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
