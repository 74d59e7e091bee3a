"""A node with its entities and named relations, as in figure 6 of the RNKG paper: SVG, DOT or lines of text.

The node is on the left, its related entities next to it by relation, and their entities on the right. Inferred
relations are dashed, extracted ones solid. The same relations always give the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final

from kg.render.svg import document, escaped, label, short
from kg.render.text import printable, width

_ROW: Final = 38
_GAP: Final = 14
"""More room between two groups of relations."""
_HIGH: Final = 28
_MARGIN: Final = 16
_WAY: Final = 230
"""Room for a line and the name of its relation."""
_NAME: Final = 118
"""Room for the name of a relation at the end of its line."""
_CHARACTER: Final = 7.9
_LONGEST: Final = 44
_FOOT: Final = 40


@dataclass(frozen=True, slots=True)
class Relation:
    """A named relation between two entities, by name; `inferred` if only rules derive it.

    `subject` is the name of the node, or of an entity related to it. Names of other entities begin with their kind or
    contain a slash, so names are unique.
    """

    subject: str
    name: str
    object: str
    inferred: bool = False


@dataclass(frozen=True, slots=True)
class _Place:
    """The box of an entity: its left edge, its middle and its width."""

    x: float
    middle: float
    wide: float


def node_graph_lines(node: str, relations: Sequence[Relation]) -> list[str]:
    """Return the relations as text: a line for each, below the node; `(inferred)` marks inferred ones."""
    of = {one.subject: [other for other in relations if other.subject == one.subject] for one in relations}
    lines = [printable(node)]
    for name, named in groupby(of.get(node, ()), key=lambda one: one.name):
        for number, one in enumerate(named):
            line = f"  {name if not number else '':<18} {printable(one.object)}"
            kinds = ", ".join(f"{other.name} {printable(other.object)}" for other in of.get(one.object, ()))
            lines.append(f"{line}{f'  ({kinds})' if kinds else ''}{'  (inferred)' if one.inferred else ''}")
    return lines


def node_graph_dot(node: str, relations: Sequence[Relation]) -> str:
    """Return the relations in the language of Graphviz."""
    lines = ["digraph node {", "  rankdir=LR; node [shape=box, style=rounded];", f"  {_dot(node)} [penwidth=3];"]
    for one in relations:
        style = ", style=dashed" if one.inferred else ""
        lines.append(f"  {_dot(one.subject)} -> {_dot(one.object)} [label={_dot(one.name)}{style}];")
    return "\n".join([*lines, "}", ""])


def node_graph_svg(node: str, relations: Sequence[Relation]) -> str:
    """Return the relations as a picture."""
    near = [one for one in relations if one.subject == node]
    far = [one for one in relations if one.subject != node]
    middle_column, places = _near_places(node, near)
    places = _far_places(far, places, middle_column)
    high = max(place.middle for place in places.values()) + _HIGH / 2 + _FOOT + _MARGIN
    right = max(place.x + place.wide for place in places.values()) + _MARGIN
    key = "dashed: inferred by rules; solid: read from the sources"
    right = max(right, 2 * _MARGIN + 7 * len(key))
    words = "; ".join(
        f"{one.subject} {one.name} {one.object}{' (inferred)' if one.inferred else ''}" for one in relations
    )
    drawn = [
        *_ways(relations, places),
        *(line for name, place in places.items() for line in _box(name, place, is_node=name == node)),
        label("key", _MARGIN, high - _MARGIN, key, longest=len(key)),
    ]
    return document("node_graph", (int(right), int(high)), f"Node {node} and its relations", f"{words}.", drawn)


def _near_places(node: str, near: Sequence[Relation]) -> tuple[float, dict[str, _Place]]:
    """Return where the second column ends, and the places of the node and of what it is related to."""
    wide = _wide(node) + 10
    x, y = _MARGIN + wide + _WAY, float(_MARGIN + _HIGH)
    places: dict[str, _Place] = {}
    for _, named in groupby(near, key=lambda one: one.name):
        for one in named:
            if one.object not in places:
                places[one.object] = _Place(x, y, _wide(one.object))
                y += _ROW
        y += _GAP
    middle = (y - _GAP - _ROW + _MARGIN + _HIGH) / 2 if places else y
    end = x + max((place.wide for place in places.values()), default=0)
    return end, {node: _Place(_MARGIN, middle, wide), **places}


def _far_places(far: Sequence[Relation], places: Mapping[str, _Place], column: float) -> dict[str, _Place]:
    """Return `places` with the entities of the third column: each near the middle of its sources."""
    leading: dict[str, list[float]] = {}
    for one in far:
        if one.object not in places:
            leading.setdefault(one.object, []).append(places[one.subject].middle)
    placed = dict(places)
    # From top to bottom by the middle of the sources, but no box above the end of the one before it.
    below = float(_MARGIN + _HIGH)
    for name, heights in sorted(leading.items(), key=lambda item: (sum(item[1]) / len(item[1]), item[0])):
        below = max(below, sum(heights) / len(heights))
        placed[name] = _Place(column + _WAY, below, _wide(name))
        below += _ROW
    return placed


def _ways(relations: Sequence[Relation], places: Mapping[str, _Place]) -> Iterator[str]:
    """Yield the lines: each ends level, below the name of its relation, so that no line crosses a name."""
    names: dict[str, dict[str, None]] = {}
    for one in relations:
        names.setdefault(one.object, {})[one.name] = None
        start, end = places[one.subject], places[one.object]
        x, y, far, level = start.x + start.wide, start.middle, end.x - _NAME, end.middle
        bend = (far - x) / 2
        curve = f"M{x:g} {y:g}C{x + bend:g} {y:g} {far - bend:g} {level:g} {far:g} {level:g}H{end.x:g}"
        yield f'<path class="{"way inferred" if one.inferred else "way"}" d="{curve}"/>'
    for entity, labels in names.items():
        end = places[entity]
        yield label("relation", end.x - 6, end.middle - 5, ", ".join(labels), "end")


def _box(name: str, place: _Place, *, is_node: bool) -> Iterator[str]:
    top = place.middle - _HIGH / 2
    kind = "box node" if is_node else "box"
    yield f"<g><title>{escaped(name)}</title>"
    yield f'<rect class="{kind}" x="{place.x:g}" y="{top:g}" width="{place.wide:g}" height="{_HIGH}" rx="9"/>'
    style = "title" if is_node else "name"
    yield label(style, place.x + place.wide / 2, place.middle + 5, name, "middle", _LONGEST) + "</g>"


def _wide(name: str) -> float:
    return width(short(name, _LONGEST)) * _CHARACTER + 24


def _dot(text: str) -> str:
    return json.dumps(printable(text), ensure_ascii=False)
