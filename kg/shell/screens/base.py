"""What the screens above the main screen have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.await_complete import AwaitComplete
from textual.screen import Screen, ScreenResultType

if TYPE_CHECKING:
    from kg.shell.app import Shell


class UpperScreen(Screen[ScreenResultType | None]):
    """A screen that closes once; its result is None when the person leaves it.

    Other bases come before this one: textual takes styles from the first base alone.
    """

    app: Shell

    def dismiss(self, result: ScreenResultType | None = None) -> AwaitComplete:
        """Close this screen if it is on top: textual would close whatever screen is."""
        return super().dismiss(result) if self.app.screen is self else AwaitComplete()

    def action_dismiss_screen(self) -> None:
        """Return to the screen below."""
        self.dismiss()
