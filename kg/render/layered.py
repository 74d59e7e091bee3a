"""Places for boxes, and ways between them, from left to right: few crossings, ways around boxes, boxes within boxes.

The layout is the work of graphlay (layers, crossing reduction, network simplex, orthogonal routing); the same input
gives the same places on every run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from kg.lazily import lazily

with lazily():
    import graphlay

_OPTIONS: Final = {
    "direction": "leftright",
    "routing": {"style": "orthogonal"},
    "spacing": {
        "layer_gap": 34.0,
        "node_gap": 18.0,
        "dummy_gap": 12.0,
        "port_gap": 9.0,
        "isolated_gap": 20.0,
        "compound_padding": 16.0,
        "compound_header": 26.0,
    },
}


@dataclass(frozen=True, slots=True)
class Node:
    """A box to be placed, with its size; `within` is the key of the box that it lies in, which grows around it."""

    key: str
    wide: float
    high: float
    within: str | None = None


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A place: left and upper edge, width and height."""

    x: float
    y: float
    wide: float
    high: float


@dataclass(frozen=True, slots=True)
class Places:
    """The positions of boxes, the corners of each line from its source to its target, and the total size."""

    boxes: Mapping[str, Rectangle]
    ways: tuple[tuple[tuple[float, float], ...], ...]
    wide: float
    high: float


def lay_out(nodes: Sequence[Node], links: Sequence[tuple[str, str]]) -> Places:
    """Return places for `nodes`; `links` are pairs of their keys, from source to target, and may form cycles."""
    numbers = {node.key: number for number, node in enumerate(nodes)}
    described = []
    for node in nodes:
        size = {"width": float(node.wide), "height": float(node.high)}
        parent = {} if node.within is None else {"parent": numbers[node.within]}
        described.append({"size": size, "shape": "box", "key": node.key, **parent})
    graph = {
        "nodes": described,
        "edges": [{"source": numbers[source], "target": numbers[target], "weight": 1.0} for source, target in links],
    }
    drawn: dict[str, Any] = graphlay.layout(graph, options=_OPTIONS).to_dict()
    rectangles = []
    for one in drawn["nodes"]:
        wide, high = one["size"]["width"], one["size"]["height"]
        rectangles.append(Rectangle(one["center"]["x"] - wide / 2, one["center"]["y"] - high / 2, wide, high))
    ways = [[(point["x"], point["y"]) for point in edge["points"]] for edge in drawn["edges"]]
    xs = [x for box in rectangles for x in (box.x, box.x + box.wide)] + [x for way in ways for x, _ in way]
    ys = [y for box in rectangles for y in (box.y, box.y + box.high)] + [y for way in ways for _, y in way]
    left, top = min(xs, default=0.0), min(ys, default=0.0)
    return Places(
        {
            node.key: Rectangle(round(box.x - left, 1), round(box.y - top, 1), round(box.wide, 1), round(box.high, 1))
            for node, box in zip(nodes, rectangles, strict=True)
        },
        tuple(tuple((round(x - left, 1), round(y - top, 1)) for x, y in way) for way in ways),
        round(max(xs, default=0.0) - left, 1),
        round(max(ys, default=0.0) - top, 1),
    )
