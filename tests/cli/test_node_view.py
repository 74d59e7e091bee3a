"""Plugin slots and parameters in `kg node`."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from kg.cli.commands.node import node_view
from kg.cli.links import Links
from kg.facts import Access, Location, NodeKind, NodeReference, NodeType, Parameter, PluginDefault, PluginSlot
from kg.graph.reading.nodes import NodeRecord

PLACE = Location("src/server.cpp", 12)


def shown(slot: PluginSlot, plugins: dict[str, tuple[NodeReference, str]] | None = None) -> str:
    """Return the output of a wide terminal for a node with one slot."""
    return drawn(NodeType("server", NodeKind.EXECUTABLE, "cpp", 2, PLACE, slots=(slot,)), plugins)


def drawn(node: NodeType, plugins: dict[str, tuple[NodeReference, str]] | None = None) -> str:
    """Return the output of a wide terminal for a node."""
    record = NodeRecord("local/ws", None, "nav", node, plugins=plugins or {})
    console = Console(file=io.StringIO(), width=200, color_system=None)
    with console.capture() as captured:
        console.print(*node_view(record, Links.of([]), 200, every=False))
    return captured.get()


def test_a_slot_shows_its_parameters_and_defaults() -> None:
    """A line has the base class, the parameters, each default with its record, and the place."""
    slot = PluginSlot("nav::Planner", PLACE, "planners", "{id}.plugin", (PluginDefault("nav::Fast", "fast"),))
    text = shown(slot, {"nav::Fast": (NodeReference("local/ws", "plans", "Fast"), "urn:x")})
    (line,) = [line for line in text.splitlines() if "nav::Planner" in line]
    assert "plugins it loads" in text
    assert line.split() == [
        *("nav::Planner", "parameters", "planners,", "{id}.plugin"),
        *("=", "fast:", "nav::Fast", "(plans/Fast)", "src/server.cpp:12"),
    ]


@pytest.mark.parametrize(
    ("slot", "words"),
    [
        (PluginSlot("nav::Planner", PLACE, "~/plugins", "~/plugins[].type"), "parameter ~/plugins[].type"),
        (PluginSlot("nav::Planner", PLACE, defaults=(PluginDefault("a::B"),), fixed=True), "fixed in the code"),
        (PluginSlot("nav::Planner", PLACE, reason="it is computed"), "not known: it is computed"),
        (PluginSlot(None, PLACE), "(not known)"),
    ],
)
def test_a_slot_says_what_gives_the_class(slot: PluginSlot, words: str) -> None:
    """The class is given by a parameter, by the code, or unknown."""
    assert words in shown(slot)


def test_an_unknown_default_has_its_reason() -> None:
    """A parameter without a known default tells why it is unknown."""
    fact = Parameter("~/rate", "double", None, Access.READ, PLACE, reason="it comes from a caller")
    node = NodeType("driver", NodeKind.EXECUTABLE, "cpp", 1, PLACE, parameters=(fact,))
    assert "read  it comes from a caller" in drawn(node)
