"""The palette: textual's, for keys that arrive before its list is drawn or after it closed."""

from __future__ import annotations

from typing import Any

from textual.command import CommandList, CommandPalette

from kg.shell.screens.base import UpperScreen


class Palette(CommandPalette, UpperScreen[Any]):
    """Finds what it offers by parts of words."""

    def _action_command_list(self, action: str) -> None:
        """Move in the list, or take what is highlighted, once the list is drawn."""
        if self.query_one(CommandList).scrollable_content_region:
            super()._action_command_list(action)
