"""Layout of results on a screen of few columns."""

from __future__ import annotations

import asyncio

from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode
from rich.text import Text
from textual.app import App

from kg.render.text import width
from kg.shell.results import _LEAST, _PADDING, AnswerTable, ResultView, _cut, _fitted

TEXTS = st.text(st.characters(exclude_categories=("C", "M")), max_size=60)


@given(st.lists(st.lists(TEXTS, min_size=3, max_size=3), max_size=5), st.integers(1, 200))
def test_columns_fit_where_they_can(cells: list[list[str]], room: int) -> None:
    """Columns fit together, or have their minimum width; none is wider than its texts."""
    widths = _fitted(("a", "b", "c"), cells, room)
    fits = sum(widths) + _PADDING * len(widths) <= room
    assert fits or all(wide <= _LEAST for wide in widths)
    assert all(wide <= max([1, *(width(row[at]) for row in cells)]) for at, wide in enumerate(widths))


@given(TEXTS, st.integers(2, 50))
def test_what_is_cut_says_so(text: str, room: int) -> None:
    """An IRI keeps its end, another text its beginning."""
    for term in (NamedNode("urn:x"), Literal("x")):
        cut = _cut(text, room, term).plain
        assert width(cut) <= room
        assert cut == text or cut.startswith("…" if isinstance(term, NamedNode) else cut[:-1] + "…")


def test_texts_of_any_length_are_cut_at_once() -> None:
    """The cost of a cell depends on its width, not on the length of its text."""
    for term in (NamedNode("urn:x"), Literal("x")):
        assert width(_cut("é漢" * 10_000_000, 48, term).plain) in {47, 48}


def test_iris_are_shortened_by_what_is_known() -> None:
    """Prefixes of the query and of the store come first, then the base of the store; other IRIs are unchanged."""
    view = ResultView()
    view._base, view._prefixes = "https://kg.example/", {"ex": "https://kg.example/node/", "o": "urn:o:"}
    named = [
        NamedNode(iri) for iri in ("https://kg.example/node/a", "https://kg.example/topic/b%20c", "urn:o:x", "urn:y")
    ]
    assert [view._text(term) for term in named] == ["ex:a", "topic/b c", "o:x", "urn:y"]


def test_rows_that_are_drawn_at_once_have_room_for_their_numbers() -> None:
    """A table measures its rows when idle, which may be after it drew them."""

    async def numbers() -> int:
        table = AnswerTable()
        app = App[None]()
        async with app.run_test() as pilot:
            await app.mount(table)
            table.add_column("name", width=10)
            table.add_row(Text("scan"), label=Text("12"))
            table.render_line(1)
            await pilot.pause()
            return table._label_column.content_width

    assert asyncio.run(numbers()) == len("12")
