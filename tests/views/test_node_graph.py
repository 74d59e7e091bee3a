"""Tests of the entities that a node is related to."""

from __future__ import annotations

from typing import Any

from kg.render.node_graph import Relation
from kg.views.node_graph import node_relations


def interface(role: str, name: str, *, implicit: bool = False) -> dict[str, Any]:
    """Return an interface as the view `node` has it."""
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
    """What code declares is read, what rules say inferred; a node is no function of the same name."""
    found = node_relations(FOUND)
    assert Relation("navigation", "has function", "function navigation", inferred=True) in found
    assert Relation("navigation", "publishes", "topic /a") in found
    assert found.count(Relation("topic /a", "has message", "a/B")) == 1


def test_what_frameworks_create_is_left_out_unless_asked_for() -> None:
    """So are capabilities that follow from others."""
    more = set(node_relations(FOUND, every=True)) - set(node_relations(FOUND))
    assert {one.object for one in more} == {"capability move", "topic /rosout"} | {"a/B"}
