from __future__ import annotations

from xml.etree import ElementTree as ET

from hypothesis import given
from hypothesis import strategies as st

from kg.render.columns import Item, arrange
from kg.render.flow_picture import Box, Flow, draw_flow

BOXES = [
    Box("a", 0, "publishes", "communication", "what nodes publish"),
    Box("b", 0, "subscribes", "communication"),
    Box("=p", 1, "rnkg:publishes"),
    Box("c", 2, "feeds & needs", "wiring"),
    Box("=q", 3, "rnkg:feeds"),
    Box("d", 4, "silent", "architecture"),
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
    """Names are escaped; the description tells each box with what it derives, reads and asks to be absent."""
    picture = draw_flow("Rules <2>", BOXES, FLOWS)
    root = ET.fromstring(picture)  # noqa: S314 - made above
    words = root.findtext("{http://www.w3.org/2000/svg}desc") or ""
    assert "wiring/feeds & needs derives rnkg:feeds, reads rnkg:publishes, rnkg:feeds." in words
    assert "architecture/silent reads rnkg:publishes, asks for the absence of rnkg:feeds." in words
    assert picture.count('class="way absent"') == 1


def test_the_same_input_gives_the_same_bytes() -> None:
    """Neither the order of lines nor the run matters."""
    assert draw_flow("x", BOXES, FLOWS) == draw_flow("x", BOXES, reversed(FLOWS))


def test_an_empty_picture_is_a_picture() -> None:
    """Without boxes there is the title."""
    assert ET.fromstring(draw_flow("nothing", [], [])) is not None  # noqa: S314 - made above


@given(st.data())
def test_boxes_do_not_touch(data: st.DataObject) -> None:
    """Whatever is joined, no two boxes of a column overlap, and all lie inside the picture."""
    columns = data.draw(st.lists(st.integers(0, 4), min_size=1, max_size=14))
    columns = sorted({column: rank for rank, column in enumerate(sorted(set(columns)))}[column] for column in columns)
    items = [Item(str(number), column, 40, 20) for number, column in enumerate(columns)]
    pairs = [(one, other) for one in items for other in items if one.column < other.column]
    chosen = data.draw(st.lists(st.sampled_from(pairs), max_size=20, unique=True)) if pairs else []
    placed = arrange(items, [(one.key, other.key) for one, other in chosen])
    for item in items:
        x, y = placed.boxes[item.key]
        assert 0 <= x <= placed.wide - item.wide
        assert item.high / 2 - 1e-6 <= y <= placed.high - item.high / 2 + 1e-6
        others = [other for other in items if other.column == item.column and other.key != item.key]
        assert all(abs(placed.boxes[other.key][1] - y) >= item.high for other in others)
