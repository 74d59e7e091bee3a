"""Tests of the picture of a node with its entities and relations."""

from __future__ import annotations

import re
from xml.etree import ElementTree as ET

from hypothesis import given
from hypothesis import strategies as st

from kg.render.node_graph import Relation, node_graph_dot, node_graph_lines, node_graph_svg

AMCL = (
    Relation("amcl", "has function", "navigation", inferred=True),
    Relation("amcl", "subscribes", "topic /scan"),
    Relation("topic /scan", "has message", "sensor_msgs/LaserScan"),
    Relation("amcl", "provides", "service /a"),
    Relation("amcl", "provides", "service /b"),
    Relation("service /a", "has service type", "std_srvs/Empty"),
    Relation("service /b", "has service type", "std_srvs/Empty"),
)
_SVG = "{http://www.w3.org/2000/svg}"


def test_what_rules_inferred_is_dashed() -> None:
    """Other boxes and lines are solid."""
    root = ET.fromstring(node_graph_svg("amcl", AMCL))  # noqa: S314 - made here
    assert [path.get("class") for path in root.iter(f"{_SVG}path")] == ["way inferred", *["way"] * 6]
    assert node_graph_dot("amcl", AMCL).count("style=dashed") == 1


def test_every_entity_has_one_box_of_its_own() -> None:
    """No boxes overlap, and a type shared by two services is drawn once."""
    root = ET.fromstring(node_graph_svg("amcl", AMCL))  # noqa: S314 - made here
    boxes = [
        tuple(float(one.get(key) or 0) for key in ("x", "y", "width", "height")) for one in root.iter(f"{_SVG}rect")
    ]
    assert len(boxes) == 7
    for number, (x, y, wide, high) in enumerate(boxes):
        for left, top, width, height in boxes[number + 1 :]:
            assert x + wide <= left or left + width <= x or y + high <= top or top + height <= y


def test_relations_as_text() -> None:
    """The name of a relation appears once, with the entities at its other end and their own relations."""
    assert node_graph_lines("amcl", AMCL)[1:4] == [
        "  has function       navigation  (inferred)",
        "  subscribes         topic /scan  (has message sensor_msgs/LaserScan)",
        "  provides           service /a  (has service type std_srvs/Empty)",
    ]


@given(st.text(), st.text())
def test_any_names_make_valid_pictures(node: str, other: str) -> None:
    """No text escapes its element."""
    relations = (Relation(node, "publishes", f"topic {other}"),)
    ET.fromstring(node_graph_svg(node, relations))  # noqa: S314 - made here
    assert re.fullmatch(r'  ".*" -> ".*" \[label="publishes"\];', node_graph_dot(node, relations).splitlines()[3])
