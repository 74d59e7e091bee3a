"""What can be done with an answer: pages, evidence, copies, files."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from pyoxigraph import Literal, NamedNode
from textual.screen import Screen

from kg.query.formats import display
from kg.query.result import Graph, Solutions
from kg.shell.buffers import Buffers
from kg.shell.delivery import deliver
from kg.shell.results import columns_of
from kg.shell.writing import copied, formats_of

if TYPE_CHECKING:
    from kg.shell.app import Shell
    from kg.shell.link import Link
    from kg.shell.results import ResultView
    from kg.shell.runs import Runs


class Answering(Screen[None]):
    """The actions of the context `results`, for the main screen."""

    app: Shell
    link: Link
    runs: Runs

    @property
    def buffers(self) -> Buffers:
        """The tabs."""
        return self.query_one(Buffers)

    def _view(self) -> ResultView | None:
        """Return the answer on the screen, if there is one."""
        buffer = self.buffers.current
        return buffer.results if buffer and buffer.results.result is not None else None

    def action_next_page(self) -> None:
        """Show the next page of rows."""
        if view := self._view():
            view.turn(1)

    def action_previous_page(self) -> None:
        """Show the page of rows before."""
        if view := self._view():
            view.turn(-1)

    def action_all_rows(self) -> None:
        """Ask again without the limit of rows, where it cut the answer."""
        buffer = self.buffers.current
        view = self._view()
        if buffer and view and view.result and view.result.limit is not None:
            self.runs.start(buffer, buffer.asked, max(buffer.text.find(buffer.asked), 0), whole=True)

    def action_open_row(self) -> None:
        """Open what the row rests on."""
        from kg.shell.screens.page import PageScreen, row_page  # noqa: PLC0415 - start-up time

        view, buffer = self._view(), self.buffers.current
        row = view.row() if view else None
        if buffer is None or view is None or row is None or view.result is None:
            return
        query = buffer.asked if isinstance(view.result, Solutions) else ""
        fact = row if isinstance(view.result, Graph) else None
        self.app.push_screen(
            PageScreen(self.link, row_page(columns_of(view.result), row, view.row_number(), query, fact))
        )

    def action_open_cell(self) -> None:
        """Open the thing that the cell names."""
        from kg.shell.screens.page import PageScreen, thing  # noqa: PLC0415 - start-up time

        cell = view.cell() if (view := self._view()) else None
        if isinstance(cell, NamedNode):
            self.app.push_screen(PageScreen(self.link, thing(cell.value, display(cell))))
        elif view:
            self.app.notify("The cell names no thing; Enter shows the whole row.", timeout=3)

    def action_edit_place(self) -> None:
        """Open the line that the row names."""
        view = self._view()
        row = view.row() if view else None
        if view is None or view.result is None or row is None:
            return
        named = dict(zip(columns_of(view.result), row, strict=True))
        file, line = (named.get(name) for name in ("file", "line"))
        if not isinstance(file, Literal):
            self.app.notify("A row needs the column ?file (and ?line); Enter shows what it rests on.", timeout=5)
            return
        deliver(
            self, partial(self.link.call, "place", path=file.value, line=display(line)), self.app.edit, self.app.report
        )

    def action_copy_as(self) -> None:
        """Copy the cell, or the rows in a format."""
        from kg.shell.screens.choosing import ChoiceScreen  # noqa: PLC0415 - start-up time

        view = self._view()
        if view is None or view.result is None:
            return
        choices = ["cell", *formats_of(view.result)]
        self.app.push_screen(ChoiceScreen("Copy as", choices), self._copy)

    def _copy(self, chosen: str | None) -> None:
        view = self._view()
        if not chosen or view is None or view.result is None:
            return
        if chosen == "cell":
            cell = view.cell()
            self.app.copy(display(cell), "the cell")
        else:
            self.app.copy(copied(view.result, chosen), f"the answer as {chosen}")

    def action_export(self) -> None:
        """Write the whole answer to a file."""
        from kg.shell.screens.export import ExportScreen  # noqa: PLC0415 - start-up time

        view, buffer = self._view(), self.buffers.current
        if buffer and view is not None and view.result is not None:
            self.app.push_screen(ExportScreen(self.link, view.result, buffer.asked))
