"""Tests of the entities related to a node."""

from __future__ import annotations

from typing import Any

from kg.render.node_graph import Relation
from kg.views.node_graph import node_relations


def interface(role: str, name: str, *, implicit: bool = False) -> dict[str, Any]:
    """Return an interface in the form of the view `node`."""
    return {"role": role, "kind": "topic", "resolved": name, "written": "x", "type": "a/B", "implicit": implicit}


FOUND = {
    "name": "navigation",
    "package": {"name": "p"},
    "repository": {"name": "r"},
    "executable": None,
    "functions": [{"label": "navigation", "inferred": True}],
    "hardware": [],
    "devices": [],
    "capabilities": [{"label": "move", "inferred": True, "general": True}],
    "interfaces": [
        interface("publishes", "/a"),
        interface("subscribes", "/a"),
        interface("publishes", "/rosout", implicit=True),
    ],
}


def test_relations_have_the_names_of_rnkg() -> None:
    """Declared relations are marked as read, those from rules as inferred; a node and a function may share a name."""
    found = node_relations(FOUND)
    assert Relation("navigation", "has function", "function navigation", inferred=True) in found
    assert Relation("navigation", "publishes", "topic /a") in found
    assert found.count(Relation("topic /a", "has message", "a/B")) == 1


def test_what_frameworks_create_is_left_out_unless_asked_for() -> None:
    """Implicit interfaces and implied capabilities are omitted by default."""
    more = set(node_relations(FOUND, every=True)) - set(node_relations(FOUND))
    assert {one.object for one in more} == {"capability move", "topic /rosout"} | {"a/B"}
