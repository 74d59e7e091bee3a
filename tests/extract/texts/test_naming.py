"""Words of a text that name a node, and ordinary words."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.texts.naming import Names
from kg.facts import Location, NodeKind, NodeType

HERE = Location("a.cpp", 1)
NODES = (
    NodeType("laser_merger", NodeKind.EXECUTABLE, "cpp", 1, HERE, executable="laser_merger_node"),
    NodeType("talker", NodeKind.SCRIPT, "python", 1, HERE, executable="talker.py"),
    NodeType("Box", NodeKind.NODELET, "cpp", 1, HERE, plugin="filters/CropBox"),
    NodeType("arm", NodeKind.EXECUTABLE, "cpp", 1, HERE, executable="arm"),
)
NAMES = Names(NODES, {"arm"}.__contains__)


@pytest.mark.parametrize(
    ("heading", "nodes"),
    [
        ("laser_merger", ("laser_merger",)),
        ("Laser Merger", ("laser_merger",)),
        ("2.1 The laser_merger_node", ("laser_merger",)),
        ("`talker`", ("talker",)),
        ("talker.py", ("talker",)),
        ("CropBox nodelet", ("Box",)),
        ("arm", ()),
        ("arm node", ("arm",)),
        ("How to build the talker and start it", ()),
        ("", ()),
    ],
)
def test_headings(heading: str, nodes: tuple[str, ...]) -> None:
    """A heading is about the node it names, in any spelling, unless the name is the package's."""
    assert NAMES.of_heading(heading) == nodes


@pytest.mark.parametrize(
    ("text", "spans", "nodes"),
    [
        ("The laser_merger merges scans.", (), ("laser_merger",)),
        ("A laser merger merges scans.", (), ()),
        ("It is a talker by nature.", (), ()),
        ("The talker says hello.", ("talker",), ("talker",)),
        ("The talker node says hello.", (), ("talker",)),
        ("The node 'talker' says hello.", (), ("talker",)),
        ("The arm moves.", ("arm",), ()),
        ("my_laser_merger is another one.", (), ()),
    ],
)
def test_paragraphs(text: str, spans: tuple[str, ...], nodes: tuple[str, ...]) -> None:
    """A paragraph names a node by a name that is not a word, by a marked word, or next to the word `node`."""
    assert NAMES.of_text(text, spans) == nodes


@pytest.mark.parametrize(
    ("lead", "nodes"),
    [("talker", ("talker",)), ("Box nodelet", ("Box",)), ("the talker speaks", ()), ("arm", ()), ("", ())],
)
def test_leads(lead: str, nodes: tuple[str, ...]) -> None:
    """The beginning of an item names a node if it consists of the name."""
    assert NAMES.of_lead(lead) == nodes


@given(st.text(max_size=200))
def test_any_text_is_searched(text: str) -> None:
    """Any text names only existing nodes."""
    known = {node.name for node in NODES}
    assert {*NAMES.of_text(text), *NAMES.of_heading(text), *NAMES.of_lead(text)} <= known
