from __future__ import annotations

import pytest
from graph.samples import IRIS, REPOSITORY, ROVER, loaded, rows, sample, source_triples, true

from kg.facts import Field, InterfaceDefinition, Location, Package, PackageFacts
from kg.graph.definitions import message_of


def test_a_definition_is_of_its_type_and_stands_in_its_file() -> None:
    """The type is shared; the definition belongs to the source with the file."""
    definition = f"<definition/{ROVER}/rover_msgs/srv/SetSpeed>"
    assert true(
        sample(),
        f"""<package/{ROVER}/rover_base> rnkg:contains {definition} .
        {definition} a rnkg:InterfaceDefinition ; rdfs:label "rover_msgs/SetSpeed" ; rnkg:definitionKind "srv" ;
          rnkg:defines <service-type/rover_msgs/SetSpeed> ; rnkg:path "rover_base/srv/SetSpeed.srv" ; rnkg:line 1 .""",
    )


def test_fields_keep_section_order_type_and_comment() -> None:
    """Fields of the same name in request and response are distinct; constants have their value."""
    query = """SELECT ?position ?section ?name ?type ?constant ?comment { ?d rnkg:hasField ?f .
      ?f rnkg:position ?position ; rnkg:section ?section ; rnkg:name ?name ; rnkg:fieldType ?type
      OPTIONAL { ?f rnkg:constantValue ?constant } OPTIONAL { ?f rdfs:comment ?comment } }"""
    assert rows(sample(), query) == [
        ("1", "request", "speed", "geometry_msgs/Twist", None, "in the base frame"),
        ("2", "request", "MAX", "float32", "2.5", None),
        ("3", "response", "speed", "float32[]", None, None),
    ]


def test_fields_lead_to_the_messages_they_hold() -> None:
    """A field of a message type is linked to that message, for following nested messages."""
    assert rows(sample(), "SELECT ?m { ?f rnkg:hasFieldType ?m }") == [("message/geometry_msgs/Twist",)]


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("float64", None),
        ("uint8[]", None),
        ("string<=10", None),
        ("string<=10[<=3]", None),
        ("time", None),
        ("", None),
        ("geometry_msgs/Point32[4]", "geometry_msgs/Point32"),
        ("geometry_msgs/msg/Point", "geometry_msgs/Point"),
        ("Wheel[<=4]", "rover_msgs/Wheel"),
        ("Header", "std_msgs/Header"),
    ],
)
def test_the_message_that_a_field_holds(written: str, message: str | None) -> None:
    """Bounds and sizes are ignored, bare names are of the same package, `Header` is of std_msgs."""
    assert message_of(written, "rover_msgs") == message


def test_a_field_declared_twice_is_two_fields() -> None:
    """A malformed definition does not merge two fields into one with two types."""
    fields = (Field("message", "x", "int8", 1), Field("message", "x", "int16", 2))
    definition = InterfaceDefinition("msg", "p", "M", fields, Location("p/msg/M.msg", 1))
    facts = PackageFacts(ROVER, Package("p", "p", 1, Location("p/package.xml", 1)), definitions=(definition,))
    store = loaded(source_triples(REPOSITORY, [facts], IRIS))
    query = "SELECT ?f (COUNT(?t) AS ?types) { ?d rnkg:hasField ?f . ?f rnkg:fieldType ?t } GROUP BY ?f"
    assert [row[1] for row in rows(store, query)] == ["1", "1"]
