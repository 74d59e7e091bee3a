"""Inferred classes of a node, by their labels."""

from __future__ import annotations

from pyoxigraph import RdfFormat, Store

from kg.graph.reading.classes import Class, Classes, Grade, classes

NODE = "https://w3id.org/rnkg/node/local/ws/base/driver"
INFERRED = f"""
@prefix rnkg: <https://w3id.org/rnkg/ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
<{NODE}> rnkg:hasFunction <x:two>, <x:one> ; rnkg:usesHardware <x:scanner> ; rnkg:usesDevice <x:utm> .
<{NODE}> rnkg:gradeStrong <x:two> ; rnkg:byName <x:two> ; rnkg:byCode <x:two> ; rnkg:gradeCertain <x:scanner> .
<x:one> rdfs:label "control"@en . <x:two> rdfs:label "navigation"@en .
<x:scanner> rdfs:label "laser scanner"@en . <x:utm> rdfs:label "Hokuyo UTM-30LX" .
"""


def test_classes_are_read_by_their_labels() -> None:
    """Functions, hardware and devices of the node, sorted by grade and label, without language tags."""
    store = Store()
    store.load(INFERRED, RdfFormat.TURTLE)
    found = classes(store, NODE)
    assert found == Classes(
        (Class("navigation", Grade("strong", ("name", "code"))), Class("control")),
        (Class("laser scanner", Grade("certain")),),
        (Class("Hokuyo UTM-30LX"),),
    )
    assert list(map(str, found.functions)) == ["navigation (strong: name, code)", "control"]
    assert str(found.hardware[0]) == "laser scanner (certain)"


def test_nothing_is_said_where_nothing_was_inferred() -> None:
    """A store without rules has no classes."""
    assert classes(Store(), NODE) == Classes()
