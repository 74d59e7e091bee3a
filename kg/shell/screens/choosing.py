"""A small list to choose one word from."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from kg.shell.actions import bindings
from kg.shell.options import Options
from kg.shell.screens.base import UpperScreen

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual.app import ComposeResult
    from textual.binding import BindingType


class ChoiceScreen(ModalScreen[str | None], UpperScreen[str]):
    """Asks for one of `choices`; its answer is None when the person chose nothing."""

    CONTEXTS = ("list",)
    BINDINGS: ClassVar[list[BindingType]] = bindings("list")

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
        """Begin at the first."""
        self.query_one(OptionList).highlighted = 0

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer with the choice."""
        self.dismiss(event.option.id)

    def action_choose(self) -> None:
        """Answer with what is highlighted."""
        self.query_one(OptionList).action_select()
