"""The lists of classes and properties."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.query.rows import rows
from kg.syntax.names import PREFIXES
from kg.views.listing import listing

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def _row(snapshot: EmbeddedSnapshot, settings: Settings, of: str, name: str) -> dict[str, Any]:
    found = listing(snapshot, settings, of=of)["rows"]
    return next(one for one in found if one["name"] == name)


def test_a_class_has_its_instances_parents_and_properties(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The number of instances is exact, and the list of properties of a class has as many as the class reports."""
    found = _row(snapshot, settings, "classes", "ros:Publisher")
    answer = rows(snapshot, f"SELECT (COUNT(DISTINCT ?s) AS ?n) {{ GRAPH ?g {{ ?s a <{PREFIXES['ros']}Publisher> }} }}")
    assert found["instances"] == int(next(iter(answer))[0]) > 10
    assert found["parents"] == ["ros:CommunicationComponent"]
    assert found["description"]
    of_it = listing(snapshot, settings, of="properties", subject="ros:Publisher")
    assert of_it["total"] - 1 == found["properties"] > 5  # rdf:type is in the list
    assert set(found["first"]) <= {one["name"] for one in of_it["rows"]}


def test_a_property_has_the_classes_that_it_connects(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A property between things has the classes of both ends; one with texts leads to literals."""
    found = _row(snapshot, settings, "properties", "rnkg:publishes")
    assert "rnkg:NodeType" in found["subjects"]
    assert "ros:Topic" in found["values"]
    assert _row(snapshot, settings, "properties", "rnkg:path")["values"] == ["literal"]
