"""Help: all keys by context."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from rich.table import Table
from rich.text import Text
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from kg.shell.actions import CONTEXTS, Action, key_words
from kg.shell.screens.base import UpperScreen

if TYPE_CHECKING:
    from collections.abc import Iterable

    from textual.app import ComposeResult


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
