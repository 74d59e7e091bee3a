"""Descriptions read from the graph: the best first, and the summary sentence."""

from __future__ import annotations

import pytest
from graph.samples import source_triples
from pyoxigraph import RdfFormat, Store

from kg.facts import Description, DescriptionKind, Location, NodeKind, NodeType, Package, PackageFacts, Repository
from kg.graph.iris import Iris
from kg.graph.reading.nodes import node_records
from kg.graph.records import node_object
from kg.graph.texts import summary

NODE = NodeType("arm", NodeKind.EXECUTABLE, "cpp", 1, Location("src/arm.cpp", 3), executable="arm")
COMMENT = Description("Moves the arm. Slowly.", DescriptionKind.COMMENT, Location("src/arm.cpp", 1), "arm")
README = Description("Drives the joints.", DescriptionKind.README, Location("README.md", 7), "arm", "Nodes")
MANIFEST = Description("Everything of the arm.", DescriptionKind.MANIFEST, Location("package.xml", 3))


def stored(*said: Description) -> Store:
    """Return a store with the node, its descriptions and its package."""
    package = Package("arms", ".", 1, Location("package.xml", 1))
    facts = PackageFacts("local/arms", package, nodes=(NODE,), descriptions=said)
    store = Store()
    store.load(source_triples(Repository("local/arms", "/"), [facts], Iris("http://x/")), RdfFormat.N_TRIPLES)
    return store


def test_descriptions_come_back() -> None:
    """The descriptions of a node are read unchanged, without those of its package, the best first."""
    (record,) = node_records(stored(COMMENT, MANIFEST, README))
    assert [(one.text, one.kind, one.location, one.heading) for one in record.descriptions] == [
        (one.text, one.kind, one.location, one.heading) for one in (README, COMMENT)
    ]


def test_programs_get_the_first_sentence() -> None:
    """`kg nodes --json` has the first sentence of the best description, or null."""
    assert node_object(node_records(stored(COMMENT))[0])["description"] == "Moves the arm."
    assert node_object(node_records(stored())[0])["description"] is None


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("Drives the arm, e.g. slowly. Then waits.", "Drives the arm, e.g. slowly."),
        ("Reads ROS 2.0 topics", "Reads ROS 2.0 topics"),
        ("It waits! Then it moves.", "It waits!"),
    ],
)
def test_the_first_sentence(text: str, first: str) -> None:
    """A sentence ends at a full stop before a capital letter, not within abbreviations and numbers."""
    assert summary([Description(text, DescriptionKind.WIKI, Location("a", 1))]) == first
