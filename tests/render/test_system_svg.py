from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree as ET

from hypothesis import given, settings
from hypothesis import strategies as st
from render.systems import CAMERA, end, instance, system

from kg.facts import Role, StartKind
from kg.render.layered import Node, lay_out
from kg.render.system_graph import system_graph
from kg.render.system_svg import system_svg
from kg.render.system_views import overlaid

GRAPH = system_graph(system(CAMERA))
SVG = "{http://www.w3.org/2000/svg}"


def test_the_picture_is_xml_and_says_in_words_what_it_draws() -> None:
    """Names and conditions are escaped; the description lists each node with its outputs and services."""
    root = ET.fromstring(system_svg(GRAPH))  # noqa: S314 - made above
    words = root.findtext(f"{SVG}desc") or ""
    assert "/driver sends to topic /raw." in words
    assert "/base serves action /dock, service /clear." in words
    assert 'if $(arg "use" & more)' in [text.text for text in root.iter(f"{SVG}text")]
    assert not list(root.iter(f"{SVG}script"))


def test_what_leads_nowhere_stands_in_its_node() -> None:
    """An end without a peer is a line of the box; one with an unknown name has a question mark."""
    texts = [text.text for text in ET.fromstring(system_svg(GRAPH)).iter(f"{SVG}text")]  # noqa: S314 - made above
    assert "← /mode" in texts
    assert "→ ? topic_" in texts
    assert "/raw" in texts


def test_a_line_that_depends_on_a_condition_is_dotted() -> None:
    """The key explains it, and the line names the condition; without such lines, the key does not."""
    sender, listener = end(Role.PUBLISHES, "/x"), end(Role.SUBSCRIBES, "/x")
    doubtful = replace(listener, switches=("use_x",))
    dotted, plain = (
        system_svg(system_graph(system([instance("/a", sender), instance("/b", one)]))) for one in (doubtful, listener)
    )
    assert dotted.count("way topic perhaps") == 1
    assert "<title>/x if use_x to /b</title>" in dotted
    assert "dotted: only under a condition" in dotted
    assert "perhaps" not in plain.partition("</style>")[2]
    assert "dotted" not in plain.partition("</style>")[2]


def test_many_ends_that_lead_nowhere_are_counted() -> None:
    """The size of a box is bounded."""
    graph = system_graph(system([instance("/a", *(end(Role.PUBLISHES, f"/t{number}") for number in range(20)))]))
    assert "+ 13 more; kg node shows them" in system_svg(graph)


def test_changes_have_a_sign_besides_their_colour() -> None:
    """Added, removed and changed nodes are distinguishable without colour."""
    after = system_graph(system([*CAMERA[:-1], instance("/extra")]))
    picture = system_svg(overlaid(GRAPH, after, {"/driver"}))
    assert "+ /extra" in picture
    assert "- /base" in picture
    assert "~ /driver" in picture


def test_an_empty_system_is_a_picture() -> None:
    """Without nodes the picture has the title."""
    assert ET.fromstring(system_svg(system_graph(system([])))) is not None  # noqa: S314 - made above


@st.composite
def systems(draw: st.DrawFn) -> list[tuple[str, list[tuple[Role, str]], bool]]:
    """Nodes with ends at a few topics, some in a host."""
    ends = st.lists(st.tuples(st.sampled_from(Role), st.sampled_from(["/a", "/b", "/c", "/d", "/e"])), max_size=6)
    return [(f"/n{number}", draw(ends), draw(st.booleans())) for number in range(draw(st.integers(0, 12)))]


@settings(max_examples=25, deadline=None)
@given(systems())
def test_any_system_can_be_drawn_and_gives_the_same_bytes_again(
    parts: list[tuple[str, list[tuple[Role, str]], bool]],
) -> None:
    """Cycles, self-connections, hosts with and without parts: the picture is XML, and equal in each run."""
    nodes = [
        instance(
            name,
            *(end(role, topic) for role, topic in ends),
            kind=StartKind.NODELET if hosted else StartKind.NODE,
            host="/n0" if hosted and name != "/n0" else None,
        )
        for name, ends, hosted in parts
    ]
    picture = system_svg(system_graph(system(nodes)))
    assert ET.fromstring(picture) is not None  # noqa: S314 - made above
    assert picture == system_svg(system_graph(system(reversed(nodes))))


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_boxes_do_not_touch(data: st.DataObject) -> None:
    """For any connections, no boxes overlap except a host and its parts, and all lie inside the picture."""
    size = data.draw(st.integers(1, 14))
    hosted = [data.draw(st.booleans()) for _ in range(size)]
    nodes = [Node("host", 40, 20), *(Node(str(n), 60, 24, "host" if hosted[n] else None) for n in range(size))]
    pairs = st.tuples(st.integers(0, size - 1), st.integers(0, size - 1))
    links = [(str(one), str(other)) for one, other in data.draw(st.lists(pairs, max_size=20, unique=True))]
    places = lay_out(nodes, links)
    assert len(places.ways) == len(links)
    for one, other in combinations(nodes, 2):
        a, b = places.boxes[one.key], places.boxes[other.key]
        apart = a.x + a.wide <= b.x or b.x + b.wide <= a.x or a.y + a.high <= b.y or b.y + b.high <= a.y
        assert apart or "host" in {one.within, other.within}
    for box in places.boxes.values():
        assert box.x >= 0
        assert box.y >= 0
        assert box.x + box.wide <= places.wide + 0.2
        assert box.y + box.high <= places.high + 0.2


def test_parts_of_a_host_that_are_joined_to_nothing_stand_side_by_side() -> None:
    """Nine of them are not arranged as one tower."""
    parts = [instance(f"/part{number}", host="/host") for number in range(9)]
    picture = ET.fromstring(system_svg(system_graph(system([instance("/host"), *parts]))))  # noqa: S314 - made above
    lefts = {box.get("x") for box in picture.iter(f"{SVG}rect") if box.get("class") == "box"}
    assert len(lefts) == 3
