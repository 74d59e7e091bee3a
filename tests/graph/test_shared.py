from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kg.facts import Interface, Location, NodeKind, NodeType, Package, PackageFacts, Resolution, Role
from kg.graph.iris import Iris
from kg.graph.packages import package_triples
from kg.graph.shared import split

IRIS = Iris()


def facts(repository: str, topic: str) -> PackageFacts:
    """Return a package of one node that publishes one topic."""
    place = Location("src/a.cpp", 3)
    end = Interface(Role.PUBLISHES, topic, "std_msgs/String", Resolution.LITERAL, place, resolved=topic)
    node = NodeType("talker", NodeKind.EXECUTABLE, "cpp", 1, place, executable="talker", interfaces=(end,))
    return PackageFacts(repository, Package("demo", ".", 1, Location("package.xml", 1)), nodes=(node,))


def test_two_sources_state_nothing_twice_but_what_they_share() -> None:
    """Private triples of two sources with the same code are disjoint, shared ones are equal."""
    one, other = (split(package_triples(facts(name, "/chatter"), IRIS), IRIS) for name in ("local/a", "local/b"))
    assert not set(one[0]) & set(other[0])
    assert set(one[1]) == set(other[1])
    assert any(b"<https://w3id.org/rnkg/topic/chatter>" in line for line in one[1])


@given(st.text(st.characters(codec="utf-8"), min_size=1))
def test_nothing_is_lost_or_made_up(name: str) -> None:
    """Both halves together equal the original lines, for any topic name."""
    content = package_triples(facts("local/a", f"/{name}"), IRIS)
    own, shared = split(content, IRIS)
    assert sorted(own + shared) == sorted(content.splitlines(keepends=True))
