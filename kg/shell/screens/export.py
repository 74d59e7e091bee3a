"""Export of a whole result to a file."""

from __future__ import annotations

import asyncio
import secrets
from functools import partial
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Select, Static

from kg.render.text import printable
from kg.shell.delivery import deliver
from kg.shell.screens.base import UpperScreen
from kg.shell.writing import file_formats_of, format_of_name, is_taken, to_file

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from kg.errors import KgError
    from kg.query.result import Result
    from kg.shell.link import Link


class ExportScreen(ModalScreen[None], UpperScreen[None], context="list"):
    """Asks for file and format; a limited result is requested again without limit."""

    def __init__(self, link: Link, result: Result, text: str) -> None:
        super().__init__()
        self._link = link
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
            result = await self._link.ask(self._text, job=self._job, rows=None)
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
        self._link.stop(self._job)
        self.dismiss()
