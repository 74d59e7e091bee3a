from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.render.node_picture import Port, draw

SVG: Final = "{http://www.w3.org/2000/svg}"
ROLES: Final = ("subscribes", "services", "action_servers", "publishes", "clients", "action_clients")
GOLDEN: Final = Path(__file__).parent / "node_picture.svg"


def rover() -> str:
    """Return the picture of a node with one port of each role and an implicit one."""
    ports = [Port(role, f"~/{role}", f"rover_msgs/{role.title().replace('_', '')}") for role in ROLES]
    ports.append(Port("publishes", "/rosout", "rosgraph_msgs/Log", implicit=True))
    return draw("rover", ["rover_base, ROS 1", "rosrun rover_base rover"], ports, more="2 more from frameworks")


def test_the_picture_is_the_one_that_was_looked_at() -> None:
    """The drawing equals the file next to this test, which was checked by eye."""
    assert rover() == GOLDEN.read_text(encoding="utf-8")


def test_order_of_ports_does_not_matter() -> None:
    """The same node gives the same bytes in any order of its ports."""
    ports = [Port(role, name, "p/T") for role in ROLES for name in ("b", "a")]
    assert draw("n", [], ports) == draw("n", [], reversed(ports))


def test_a_screen_reader_hears_every_port() -> None:
    """The description names each interface with its type and role."""
    description = ET.fromstring(rover()).findtext(f"{SVG}desc") or ""  # noqa: S314 - drawn by the test itself
    assert "It subscribes ~/subscribes (rover_msgs/Subscribes)." in description
    assert "It calls actions ~/action_clients (rover_msgs/ActionClients)." in description
    assert description.endswith("2 more from frameworks.")


def test_a_node_without_interfaces_still_has_a_picture() -> None:
    """The picture has the box alone, with a text that explains it."""
    assert "no topics, services or actions" in draw("lonely", ["p"], [])


@pytest.mark.parametrize("count", [1, 30])
def test_ports_never_overlap(count: int) -> None:
    """Labels of a side are below each other, even for thirty interfaces."""
    root = ET.fromstring(draw("n", ["p"], [Port("publishes", f"t{i}", "p/T") for i in range(count)]))  # noqa: S314 - drawn by the test itself
    heights = [float(text.get("y", "nan")) for text in root.iter(f"{SVG}text") if text.get("class") == "name"]
    assert len(heights) == count
    assert all(below - above >= 34 for above, below in pairwise(heights))


@given(st.text(), st.lists(st.builds(Port, st.sampled_from(ROLES), st.text(), st.text(), st.booleans()), max_size=4))
def test_hostile_names_make_no_markup(title: str, ports: list[Port]) -> None:
    """For any names of interfaces, the picture is well-formed and has only its own elements."""
    root = ET.fromstring(draw(title, [title], ports, more=title))  # noqa: S314 - drawn by the test itself
    assert {element.tag.removeprefix(SVG) for element in root.iter()} <= {
        "svg",
        "title",
        "desc",
        "style",
        "rect",
        "path",
        "text",
        "g",
    }
