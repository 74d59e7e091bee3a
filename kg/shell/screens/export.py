"""Writing the whole answer to a file."""

from __future__ import annotations

import asyncio
import secrets
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Select, Static

from kg.errors import KgError
from kg.render.text import printable
from kg.shell.actions import bindings
from kg.shell.writing import file_formats_of, format_of_name, to_file

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.binding import BindingType

    from kg.query.result import Result
    from kg.shell.app import Shell
    from kg.shell.link import Link

__all__ = ["ExportScreen"]


class ExportScreen(ModalScreen[None]):
    """Asks for file and format; an answer that the limit cut is asked for again without limit."""

    CONTEXTS = ("list",)
    BINDINGS: ClassVar[list[BindingType]] = bindings("list")
    app: Shell

    def __init__(self, link: Link, result: Result, text: str) -> None:
        super().__init__()
        self._link = link
        self._result = result
        self._text = text
        self._job = secrets.token_hex(8)
        self._replace: str | None = None
        """The file that may be replaced, since the person was told that it is there."""

    def compose(self) -> ComposeResult:
        """Yield the fields."""
        formats = file_formats_of(self._result)
        with Vertical(classes="dialog"):
            yield Static("Export", classes="title")
            yield Input(placeholder="file, for example answer.csv")
            yield Select([(name, name) for name in formats], value=formats[0], allow_blank=False)
            yield Static("", classes="wrong", markup=False)
            yield Static("Enter in the field writes the file, Tab goes to the format, Esc goes back.", classes="hint")

    def on_input_changed(self, event: Input.Changed) -> None:
        """Let the ending of the name choose the format."""
        if meant := format_of_name(event.value, self._result):
            self.query_one(Select).value = meant

    async def on_input_submitted(self) -> None:
        """Write the file."""
        await self.action_choose()

    async def action_choose(self) -> None:
        """Write the file, unless one is there that nobody said may be replaced."""
        typed = self.query_one(Input).value.strip()
        if not typed:
            return
        path = _path(typed)
        if await asyncio.to_thread(path.exists) and self._replace != typed:
            self._replace = typed
            self.query_one(".wrong", Static).update("The file is there. Enter again replaces it.")
            return
        self.run_worker(self._write(path, str(self.query_one(Select).value)), exclusive=True)

    async def _write(self, path: Path, name: str) -> None:
        try:
            result = self._result
            if result.limit is not None:
                self.query_one(".wrong", Static).update("Asking for all rows …")
                result = await self._link.ask(self._text, job=self._job, rows=None)
            size = await asyncio.to_thread(to_file, result, path, name)
        except KgError as error:
            if self.is_attached:
                self.query_one(".wrong", Static).update(printable(f"{error.code}: {error.message}"))
        else:
            self.app.notify(f"Wrote {size:,} bytes to {path}.", markup=False)
            # What ends is the screen on top, which is another one once the person has gone back.
            if self.app.screen is self:
                self.dismiss(None)

    def action_dismiss_screen(self) -> None:
        """Go back; what is being asked ends."""
        self._link.stop(self._job)
        self.dismiss(None)


def _path(typed: str) -> Path:
    return Path(typed).expanduser()
