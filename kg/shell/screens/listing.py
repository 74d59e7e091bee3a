"""Choice lists: short ones, and those filtered while typing, such as the history."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from rich.text import Text
from textual import on
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from kg.render.text import count, printable
from kg.shell.screens.base import UpperScreen

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual.app import ComposeResult
    from textual.events import Key

    from kg.shell.state import Entry


_MOST = 500
MOVES = {"up": "cursor_up", "down": "cursor_down", "pageup": "page_up", "pagedown": "page_down"}
"""Keys that move in a list whose input has the focus, with the names of its actions."""


class ChoiceScreen(ModalScreen[str | None], UpperScreen[str], context="list"):
    """Asks for one of `choices`; returns None if the user chooses nothing."""

    def __init__(self, title: str, choices: Sequence[str]) -> None:
        super().__init__()
        self._title = title
        self._choices = list(choices)

    def compose(self) -> ComposeResult:
        """Yield the list."""
        with Vertical(classes="dialog small"):
            yield Static(self._title, classes="title", markup=False)
            yield Options(*(Option(choice, id=choice) for choice in self._choices), markup=False)
            yield Static("Enter: choose. Esc: back.", classes="hint")

    def on_mount(self) -> None:
        """Highlight the first entry."""
        self.query_one(OptionList).highlighted = 0

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Return the choice."""
        self.dismiss(event.option.id)

    def action_choose(self) -> None:
        """Return the highlighted entry."""
        self.query_one(OptionList).action_select()


class ListScreen(ModalScreen[str | None], UpperScreen[str], context="list"):
    """Entries with a title and a note, filtered by parts of words; the preview shows the highlighted one."""

    TITLE_WORDS = ""
    EMPTY = "There is nothing yet."

    def __init__(self) -> None:
        super().__init__()
        self.entries: list[Any] = []
        self._shown: list[Any] = []

    def words(self, entry: Any) -> tuple[str, str]:
        """Return title and note of an entry."""
        raise NotImplementedError

    def preview(self, entry: Any) -> str:
        """Return the preview of the highlighted entry."""
        raise NotImplementedError

    def choose(self, entry: Any) -> None:
        """Accept an entry."""
        raise NotImplementedError

    def compose(self) -> ComposeResult:
        """Yield the input, the list and the preview."""
        with Vertical(classes="dialog"):
            yield Static(self.TITLE_WORDS, classes="title", markup=False)
            yield Input(placeholder="type to search", select_on_focus=False)
            yield Options(markup=False)
            yield Static("", classes="preview", markup=False)
            yield Static("Enter: choose. Up and Down: move. Esc: back.", classes="hint")

    def on_mount(self) -> None:
        """Show all."""
        self.query_one(OptionList).can_focus = False
        self.fill()

    @on(Input.Changed)
    def fill(self) -> None:
        """Show the entries that contain all typed words, those with an early first word first."""
        words = self.query_one(Input).value.lower().split()
        texts = [" ".join(self.words(entry)).lower() for entry in self.entries]
        fitting = [number for number, text in enumerate(texts) if all(word in text for word in words)]
        if words:
            fitting.sort(key=lambda number: texts[number].index(words[0]))
        self._shown = [self.entries[number] for number in fitting[:_MOST]]
        listing = self.query_one(OptionList)
        listing.clear_options()
        for entry in self._shown:
            title, note = map(printable, self.words(entry))
            text = Text.assemble(title, "  ", (note, "dim"), no_wrap=True, overflow="ellipsis")
            listing.add_option(Option(text))
        listing.highlighted = 0 if self._shown else None
        if not self._shown:
            self.query_one(".preview", Static).update("Nothing fits." if self.entries else self.EMPTY)

    @on(OptionList.OptionHighlighted)
    def _highlighted(self, event: OptionList.OptionHighlighted) -> None:
        if event.option_index < len(self._shown):
            self.query_one(".preview", Static).update(self.preview(self._shown[event.option_index]))

    def on_key(self, event: Key) -> None:
        """Move in the list while the input has the focus."""
        if event.key in MOVES and isinstance(self.focused, Input):
            event.stop()
            getattr(self.query_one(OptionList), f"action_{MOVES[event.key]}")()

    @on(Input.Submitted)
    @on(OptionList.OptionSelected)
    def action_choose(self) -> None:
        """Accept the highlighted entry."""
        number = self.query_one(OptionList).highlighted
        if number is not None and number < len(self._shown):
            self.choose(self._shown[number])


class HistoryScreen(ListScreen):
    """Searches the history; returns the text of a query."""

    TITLE_WORDS = "History"
    EMPTY = "Nothing was run yet."

    def __init__(self, entries: Sequence[Entry]) -> None:
        super().__init__()
        self.entries = list(entries)

    def words(self, entry: Entry) -> tuple[str, str]:
        """Return the query on one line, and its outcome."""
        came = count(entry.rows, "row") if entry.outcome == "ok" else entry.outcome
        return " ".join(entry.text.split()), came

    def preview(self, entry: Entry) -> str:
        """Return the whole query, with time and store."""
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(entry.when))
        return f"{entry.text}\n\n{when} · {entry.seconds:.2f} s · {entry.store}"

    def choose(self, entry: Entry) -> None:
        """Return the query."""
        self.dismiss(entry.text)


class Options(OptionList):
    """Textual's list, except that paging waits until it is drawn, since it has no lines before."""

    def action_page_up(self) -> None:
        """Go up a page."""
        if self.scrollable_content_region:
            super().action_page_up()  # type: ignore[no-untyped-call]  # textual has no type here

    def action_page_down(self) -> None:
        """Go down a page."""
        if self.scrollable_content_region:
            super().action_page_down()  # type: ignore[no-untyped-call]  # as above
