"""Dialogs: choice lists such as the history, stored queries with their form, export, keys, and jump marks."""

from __future__ import annotations

import asyncio
import secrets
import time
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from rich.table import Table
from rich.text import Text
from textual import on
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Input, Label, OptionList, Select, Static
from textual.widgets.option_list import Option

from kg.render.text import count, printable
from kg.shell.actions import CONTEXTS, Action, key_words
from kg.shell.delivery import deliver
from kg.shell.results import file_formats_of, format_of_name, is_taken, to_file
from kg.shell.screens.base import UpperScreen

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from textual.app import ComposeResult
    from textual.events import Key
    from textual.widget import Widget

    from kg.errors import KgError
    from kg.query.result import Result
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


class JumpScreen(ModalScreen[Any], UpperScreen[Any]):
    """Returns the panel whose letter was typed, or None."""

    def __init__(self, panels: Mapping[str, Widget]) -> None:
        super().__init__()
        self._panels = dict(panels)

    def compose(self) -> ComposeResult:
        """Yield a letter at the corner of each panel."""
        for key, panel in self._panels.items():
            label = Label(f" {key.upper()} ", classes="jump")
            label.absolute_offset = panel.region.offset
            yield label
        yield Label("Type a letter to go to its panel; any other key goes back.", classes="jump-hint")

    def on_key(self, event: Key) -> None:
        """Return the panel of a letter."""
        event.stop()
        event.prevent_default()
        self.dismiss(self._panels.get(event.key.lower()))


class HelpScreen(ModalScreen[None], UpperScreen[None]):
    """The registry of actions as a page."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape,f1,q", "dismiss_screen", "Close")]

    def compose(self) -> ComposeResult:
        """Yield a table for each context."""
        with VerticalScroll(classes="dialog help"):
            yield Static("Keys", classes="title")
            for context, title in CONTEXTS.items():
                yield Static(title, classes="heading")
                yield Static(_table([one for one in self.app.actions if one.context == context]))
            yield Static("Esc: back. The palette (Ctrl+P) runs all of these by name.", classes="hint")

    def on_mount(self) -> None:
        """Enable scrolling by arrow keys."""
        self.query_one(VerticalScroll).focus()


def _table(actions: Iterable[Action]) -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(min_width=16, max_width=22)
    table.add_column(ratio=1)
    for action in actions:
        keys = ", ".join(key_words(key) for key in action.keys)
        table.add_row(Text(keys, "bold"), Text.assemble((action.title, "bold"), ": ", action.help))
    return table


class ExportScreen(ModalScreen[None], UpperScreen[None], context="list"):
    """Asks for file and format; a limited result is requested again without limit."""

    def __init__(self, result: Result, text: str) -> None:
        super().__init__()
        self._result = result
        self._text = text
        self._job = secrets.token_hex(8)
        self._replace: str | None = None
        """The file that the user has agreed to replace."""

    def compose(self) -> ComposeResult:
        """Yield the fields."""
        formats = file_formats_of(self._result)
        with Vertical(classes="dialog"):
            yield Static("Export", classes="title")
            yield Input(placeholder="file, for example answer.csv")
            yield Select([(name, name) for name in formats], value=formats[0], allow_blank=False)
            yield Static("", classes="wrong", markup=False)
            yield Static("Enter: write the file. Tab: format. Esc: back.", classes="hint")

    def on_input_changed(self, event: Input.Changed) -> None:
        """Set the format by the suffix of the name."""
        if form := format_of_name(event.value, self._result):
            self.query_one(Select).value = form

    @on(Input.Submitted)
    def action_choose(self) -> None:
        """Write the file, unless it exists and the user has not confirmed its replacement."""
        if typed := self.query_one(Input).value.strip():
            request = partial(self._write, typed, str(self.query_one(Select).value))
            deliver(self, request, self._answer, self._fail, latest="export")

    async def _write(self, typed: str, name: str) -> int | None:
        """Return the number of bytes written, None if the file exists."""
        if self._replace != typed and await asyncio.to_thread(is_taken, typed):
            self._replace = typed
            return None
        result = self._result
        if result.limit is not None:
            self._say("Asking for all rows …")
            result = await self.app.link.ask(self._text, job=self._job, rows=None)
        return await asyncio.to_thread(to_file, result, typed, name)

    def _answer(self, size: int | None) -> None:
        if size is None:
            self._say("The file is there. Enter again replaces it.")
        else:
            self.app.notify(f"Wrote {size:,} bytes to {self.query_one(Input).value.strip()}.", markup=False)
            self.dismiss()

    def _fail(self, error: KgError) -> None:
        self._say(f"{error.code}: {error.message}")

    def _say(self, words: str) -> None:
        self.query_one(".wrong", Static).update(printable(words))

    def action_dismiss_screen(self) -> None:
        """Go back and cancel the request."""
        self.app.link.stop(self._job)
        self.dismiss()


class StoredScreen(ListScreen):
    """Lists the stored queries; returns the text of one with its parameters bound."""

    TITLE_WORDS = "Stored queries"
    EMPTY = "Reading the stored queries …"

    def on_mount(self) -> None:
        """Request the queries."""
        super().on_mount()
        deliver(self, partial(self.app.link.call, "stored"), self._answer, self.app.report)

    def _answer(self, answer: dict[str, Any]) -> None:
        self.entries = answer["queries"]
        self.fill()

    def words(self, entry: dict[str, Any]) -> tuple[str, str]:
        """Return title, and name with parameters."""
        return entry["title"], " ".join([entry["query"], *(f"?{one['name']}" for one in entry["parameters"])])

    def preview(self, entry: dict[str, Any]) -> str:
        """Return the purpose of the query, and its text."""
        lines = [line for line in entry["text"].splitlines() if not line.startswith("#")]
        return "\n\n".join(part for part in (entry["description"], "\n".join(lines).strip()) if part)

    def choose(self, entry: dict[str, Any]) -> None:
        """Open the form for the parameters, if there are any."""
        if entry["parameters"]:
            self.app.push_screen(FormScreen(entry), self._bound)
        else:
            self.dismiss(entry["text"])

    def _bound(self, text: str | None) -> None:
        if text:
            self.dismiss(text)


class FormScreen(ModalScreen[str | None], UpperScreen[str], context="list"):
    """Asks for the parameters of a stored query; returns the text with their values."""

    def __init__(self, query: dict[str, Any]) -> None:
        super().__init__()
        self._stored = query

    def compose(self) -> ComposeResult:
        """Yield a field for each parameter."""
        with Vertical(classes="dialog"):
            yield Static(self._stored["title"], classes="title", markup=False)
            with VerticalScroll():
                for one in self._stored["parameters"]:
                    default = f"; default {one['default']}" if one["default"] else "; may be left out"
                    yield Label(f"{one['name']}: {one['description']} ({one['type']}{default})", markup=False)
                    yield Input(placeholder=f"for example {one['example']}", name=one["name"])
            yield Static("", classes="wrong", markup=False)
            yield Static("Enter: put the query into a buffer. Tab: next field. Esc: back.", classes="hint")

    def on_mount(self) -> None:
        """Focus the first field."""
        self.query(Input).first().focus()

    @on(Input.Submitted)
    def action_choose(self) -> None:
        """Return the bound query, or show which value is invalid."""
        values = {str(one.name): one.value.strip() for one in self.query(Input) if one.value.strip()}
        request = partial(self.app.link.call, "stored", name=self._stored["query"], values=values)
        deliver(self, request, lambda answer: self.dismiss(answer["bound"]), self._fail, latest="bind")

    def _fail(self, error: KgError) -> None:
        hint = f" {error.hint}" if error.hint else ""
        self.query_one(".wrong", Static).update(f"{error.code}: {error.message}.{hint}")
