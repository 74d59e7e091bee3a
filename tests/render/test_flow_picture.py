from __future__ import annotations

from xml.etree import ElementTree as ET

from kg.render.flow_picture import Box, Flow, draw_flow

BOXES = [
    Box("a", "publishes", "communication", "what nodes publish"),
    Box("b", "subscribes", "communication"),
    Box("=p", "rnkg:publishes"),
    Box("c", "feeds & needs", "wiring"),
    Box("=q", "rnkg:feeds"),
    Box("d", "silent", "architecture"),
]
FLOWS = [
    Flow("a", "=p"),
    Flow("=p", "c"),
    Flow("c", "=q"),
    Flow("=q", "c"),
    Flow("=q", "d", absent=True),
    Flow("=p", "d"),
]


def test_the_picture_is_xml_and_says_in_words_what_it_draws() -> None:
    """Names are escaped; the description lists each box with its derived, read and negated terms."""
    picture = draw_flow("Rules <2>", BOXES, FLOWS)
    root = ET.fromstring(picture)  # noqa: S314 - made above
    words = root.findtext("{http://www.w3.org/2000/svg}desc") or ""
    assert "wiring/feeds & needs derives rnkg:feeds, reads rnkg:publishes, rnkg:feeds." in words
    assert "architecture/silent reads rnkg:publishes, asks for the absence of rnkg:feeds." in words
    assert picture.count('class="way absent"') == 1


def test_the_same_input_gives_the_same_bytes() -> None:
    """The drawing does not depend on the order of lines."""
    assert draw_flow("x", BOXES, FLOWS) == draw_flow("x", BOXES, reversed(FLOWS))


def test_an_empty_picture_is_a_picture() -> None:
    """Without boxes the picture has the title."""
    assert ET.fromstring(draw_flow("nothing", [], [])) is not None  # noqa: S314 - made above
