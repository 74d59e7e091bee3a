"""Stored queries, and the form for their parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from textual import work
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Input, Label, Static

from kg.errors import KgError
from kg.shell.actions import bindings
from kg.shell.screens.listing import ListScreen

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.binding import BindingType

    from kg.shell.app import Shell
    from kg.shell.link import Link

__all__ = ["FormScreen", "StoredScreen"]


class StoredScreen(ListScreen):
    """Lists the stored queries; its answer is the text of one with its parameters bound."""

    TITLE_WORDS = "Stored queries"
    EMPTY = "Reading the stored queries …"
    app: Shell

    def __init__(self, link: Link) -> None:
        super().__init__()
        self._link = link

    def on_mount(self) -> None:
        """Ask for the queries."""
        super().on_mount()
        self._read()

    @work
    async def _read(self) -> None:
        try:
            self.entries = (await self._link.call("stored"))["queries"]
        except KgError as error:
            self.app.report(error)
        self.fill()

    def words(self, entry: dict[str, Any]) -> tuple[str, str]:
        """Return title, and name with parameters."""
        return entry["title"], " ".join([entry["query"], *(f"?{one['name']}" for one in entry["parameters"])])

    def preview(self, entry: dict[str, Any]) -> str:
        """Return what the query answers, and its text."""
        lines = [line for line in entry["text"].splitlines() if not line.startswith("#")]
        return "\n\n".join(part for part in (entry["description"], "\n".join(lines).strip()) if part)

    def choose(self, entry: dict[str, Any]) -> None:
        """Ask for the parameters, if there are any."""
        if entry["parameters"]:
            self.app.push_screen(FormScreen(self._link, entry), self._bound)
        else:
            self.dismiss(entry["text"])

    def _bound(self, text: str | None) -> None:
        if text:
            self.dismiss(text)


class FormScreen(ModalScreen[str | None]):
    """Asks for the parameters of a stored query; its answer is the text with their values in it."""

    CONTEXTS = ("list",)
    BINDINGS: ClassVar[list[BindingType]] = bindings("list")
    app: Shell

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
            yield Static(
                "Enter puts the query into a buffer, Tab goes to the next field, Esc goes back.", classes="hint"
            )

    def on_mount(self) -> None:
        """Begin in the first field."""
        self.query(Input).first().focus()

    def on_input_submitted(self) -> None:
        """Bind the values."""
        self.action_choose()

    def action_choose(self) -> None:
        """Answer with the bound query, or say which value does not fit."""
        self._bind({str(one.name): one.value.strip() for one in self.query(Input) if one.value.strip()})

    @work(exclusive=True)
    async def _bind(self, values: dict[str, str]) -> None:
        try:
            answer = await self._link.call("stored", name=self._stored["query"], values=values)
        except KgError as error:
            hint = f" {error.hint}" if error.hint else ""
            if self.is_attached:
                self.query_one(".wrong", Static).update(f"{error.code}: {error.message}.{hint}")
        else:
            # What ends is the screen on top, which is another one once the person has gone on.
            if self.app.screen is self:
                self.dismiss(answer["bound"])

    def action_dismiss_screen(self) -> None:
        """Go back to the list."""
        self.dismiss(None)
