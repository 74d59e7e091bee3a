"""Bases of the screens above the main screen, and of their trees."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from textual.await_complete import AwaitComplete
from textual.screen import Screen, ScreenResultType

from kg.shell.actions import bindings

if TYPE_CHECKING:
    from textual.binding import BindingType

    from kg.shell.app import Shell


class Acting:
    """What has the keys of a context: `class RulesScreen(UpperScreen[None], context="rules")`."""

    CONTEXTS: ClassVar[tuple[str, ...]] = ()
    BINDINGS: ClassVar[list[BindingType]]

    def __init_subclass__(cls, *, context: str = "", **more: Any) -> None:
        if context:
            cls.CONTEXTS, cls.BINDINGS = (context,), bindings(context)
        super().__init_subclass__(**more)


class UpperScreen(Acting, Screen[ScreenResultType | None]):
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
