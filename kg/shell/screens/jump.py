"""Jump marks: a letter above each panel; typing it goes there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from textual.screen import ModalScreen
from textual.widgets import Label

from kg.shell.screens.base import UpperScreen

if TYPE_CHECKING:
    from collections.abc import Mapping

    from textual.app import ComposeResult
    from textual.events import Key
    from textual.widget import Widget


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
