"""Stored queries, and the form for their parameters."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from textual import on
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Input, Label, Static

from kg.shell.delivery import deliver
from kg.shell.screens.base import UpperScreen
from kg.shell.screens.listing import ListScreen

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from kg.errors import KgError
    from kg.shell.link import Link


class StoredScreen(ListScreen):
    """Lists the stored queries; returns the text of one with its parameters bound."""

    TITLE_WORDS = "Stored queries"
    EMPTY = "Reading the stored queries …"

    def __init__(self, link: Link) -> None:
        super().__init__()
        self._link = link

    def on_mount(self) -> None:
        """Request the queries."""
        super().on_mount()
        deliver(self, partial(self._link.call, "stored"), self._answer, self.app.report)

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
            self.app.push_screen(FormScreen(self._link, entry), self._bound)
        else:
            self.dismiss(entry["text"])

    def _bound(self, text: str | None) -> None:
        if text:
            self.dismiss(text)


class FormScreen(ModalScreen[str | None], UpperScreen[str], context="list"):
    """Asks for the parameters of a stored query; returns the text with their values."""

    def __init__(self, link: Link, query: dict[str, Any]) -> None:
        super().__init__()
        self._link = link
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
        request = partial(self._link.call, "stored", name=self._stored["query"], values=values)
        deliver(self, request, lambda answer: self.dismiss(answer["bound"]), self._fail, latest="bind")

    def _fail(self, error: KgError) -> None:
        hint = f" {error.hint}" if error.hint else ""
        self.query_one(".wrong", Static).update(f"{error.code}: {error.message}.{hint}")
