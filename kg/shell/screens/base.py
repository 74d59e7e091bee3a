"""Base of the screens above the main screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.await_complete import AwaitComplete
from textual.screen import Screen, ScreenResultType

if TYPE_CHECKING:
    from kg.shell.app import Shell


class UpperScreen(Screen[ScreenResultType | None]):
    """A screen that closes once; its result is None when the user leaves it.

    It must be the last base class: textual takes styles from the first one only.
    """

    app: Shell

    def dismiss(self, result: ScreenResultType | None = None) -> AwaitComplete:
        """Close this screen if it is on top: textual would close any other."""
        return super().dismiss(result) if self.app.screen is self else AwaitComplete()

    def action_dismiss_screen(self) -> None:
        """Return to the screen below."""
        self.dismiss()
