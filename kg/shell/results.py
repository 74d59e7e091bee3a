"""A result below its query: a paged table, a truth value, or an error; and as text for the clipboard or a file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final
from urllib.parse import unquote

from pyoxigraph import NamedNode
from rich.text import Text, TextType
from textual.containers import Vertical
from textual.message import Message
from textual.widgets import DataTable, Static

from kg.errors import KgError, Place, UsageError
from kg.query.formats import BOOLEAN_FORMATS, BY_NAME, GRAPH_FORMATS, SOLUTION_FORMATS, write
from kg.query.result import Boolean, Graph, Result, Solutions
from kg.query.writing import parquet
from kg.query.writing.values import display
from kg.render.text import count, printable, width
from kg.shell.actions import bindings
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.binding import BindingType
    from textual.widgets.data_table import RowKey

    from kg.store.terms import Term


PAGE_ROWS: Final = 200
"""Maximum number of rows on a page."""
_CELL: Final = 48  # maximum characters of a displayed cell; Enter shows all
_LEAST: Final = 12  # minimum width of a column if all have to fit the screen
_PADDING: Final = 2
_TRIPLE: Final = ("subject", "predicate", "object")


def columns_of(result: Result) -> tuple[str, ...]:
    """Return the titles of a result's columns; none for a truth value."""
    if isinstance(result, Solutions):
        return result.variables
    return _TRIPLE if isinstance(result, Graph) else ()


def rows_of(result: Result) -> tuple[tuple[Term | None, ...], ...]:
    """Return the rows of a result; a graph has one for each triple."""
    if isinstance(result, Solutions):
        return result.rows
    return tuple(tuple(triple) for triple in result.triples) if isinstance(result, Graph) else ()


class AnswerTable(DataTable[Text]):
    """The current page of rows, with the keys of results."""

    BINDINGS: ClassVar[list[BindingType]] = bindings("results")

    class Passed(Message):
        """The cursor moves past the last row of the page."""

    def add_row(
        self, *cells: Text, height: int | None = 1, key: str | None = None, label: TextType | None = None
    ) -> RowKey:
        """Add a row, reserving its label's width in case it is drawn before it is measured."""
        self._labelled_row_exists = self._labelled_row_exists or label is not None
        return super().add_row(*cells, height=height, key=key, label=label)

    def action_cursor_down(self) -> None:
        """Go down; from the last row of a page to the next page."""
        if self.cursor_row >= self.row_count - 1:
            self.post_message(self.Passed())
        else:
            super().action_cursor_down()


class ResultView(Vertical):
    """The result of one buffer; `result` is None before the first and after an error."""

    def __init__(self) -> None:
        super().__init__(classes="results")
        self.result: Result | None = None
        self._rows: tuple[tuple[Term | None, ...], ...] = ()
        self._page = 0
        self._base = ""
        self._prefixes: Mapping[str, str] = PREFIXES
        self._room = 0

    def compose(self) -> ComposeResult:
        """Yield the summary line and the table."""
        yield Static("No answer yet: F5 runs the query.", classes="remark", markup=False)
        table = AnswerTable(zebra_stripes=True, cursor_type="cell", header_height=1)
        table.border_title = "Results"
        yield table

    @property
    def table(self) -> AnswerTable:
        """The table of the page."""
        return self.query_one(AnswerTable)

    @property
    def pages(self) -> int:
        """Number of pages of the result."""
        return max(1, -(-len(self._rows) // PAGE_ROWS))

    def say(self, words: str, *, wrong: bool = False) -> None:
        """Set the line above the table."""
        remark = self.query_one(".remark", Static)
        remark.update(words)
        remark.set_class(wrong, "wrong")

    def on_resize(self) -> None:
        """Fit the columns to another width of the screen."""
        if self.result is not None and self._room != self.table.size.width:
            cursor = self.table.cursor_coordinate
            self._fill(self._page)
            self.table.move_cursor(row=cursor.row, column=cursor.column)

    def show(self, result: Result, base: str = "", prefixes: Mapping[str, str] = PREFIXES) -> None:
        """Show the first page of a result; IRIs are shortened by `prefixes`, or relative to `base`."""
        self.result, self._base, self._prefixes = result, base, prefixes
        self._rows = rows_of(result)
        self._fill(0)

    def show_error(self, error: KgError, location: tuple[int, int] | None = None) -> None:
        """Show an error: its place in the buffer (line and column from zero), or else its hint."""
        self.result = None
        self._rows = ()
        self._fill(0)
        where = f"line {location[0] + 1}, column {location[1] + 1}: " if location else ""
        hint = f"\n{printable(error.hint)}" if error.hint and not location else ""
        self.say(printable(f"{error.code}: {where}{error.message}") + hint, wrong=True)

    def turn(self, by: int) -> None:
        """Show another page, if there is one."""
        if 0 <= self._page + by < self.pages:
            self._fill(self._page + by)

    def row(self) -> tuple[Term | None, ...] | None:
        """Return the row under the cursor."""
        number = self._page * PAGE_ROWS + self.table.cursor_row
        return self._rows[number] if number < len(self._rows) else None

    def row_number(self) -> int:
        """Return the number of the row under the cursor in the result, counted from one."""
        return self._page * PAGE_ROWS + self.table.cursor_row + 1

    def cell(self) -> Term | None:
        """Return the term under the cursor."""
        row = self.row()
        return row[self.table.cursor_column] if row else None

    def _fill(self, page: int) -> None:
        self._page = page
        table = self.table
        table.clear(columns=True)
        if self.result is not None:
            begin = page * PAGE_ROWS
            rows = self._rows[begin : begin + PAGE_ROWS]
            cells = [[self._text(term) for term in row] for row in rows]
            titles = columns_of(self.result)
            self._room = table.size.width
            # Leave room for the scroll bar, or the row numbers would scroll out of view.
            margin = table.styles.scrollbar_size_vertical + len(str(begin + len(rows))) + _PADDING
            widths = _fitted(titles, cells, self._room - margin)
            for title, wide in zip(titles, widths, strict=True):
                table.add_column(title, width=wide)
            for number, (row, texts) in enumerate(zip(rows, cells, strict=True), begin + 1):
                shown = (_cut(text, wide, term) for text, wide, term in zip(texts, widths, row, strict=True))
                table.add_row(*shown, label=Text(str(number), justify="right"))
            self.say(self._remark(self.result))

    def _text(self, term: Term | None) -> str:
        if not isinstance(term, NamedNode):
            return printable(display(term))
        short = shorten(term.value, self._prefixes)
        if short.startswith("<") and self._base and term.value.startswith(self._base):
            short = unquote(term.value.removeprefix(self._base))
        return printable(short.strip("<>"))

    def _remark(self, result: Result) -> str:
        seconds = f"{result.seconds:.3f} s"
        if isinstance(result, Boolean):
            return f"{'yes' if result.value else 'no'} · {seconds}"
        noun = "row" if isinstance(result, Solutions) else "triple"
        words = [count(len(self._rows), noun), seconds]
        if result.limit is not None:
            words[0] = f"only the first {words[0]} (a fetches all)"
        if self.pages > 1:
            words.append(f"page {self._page + 1} of {self.pages} (n next, b back)")
        return " · ".join(words)


def _fitted(titles: Sequence[str], cells: Sequence[Sequence[str]], room: int) -> list[int]:
    """Return the widths of columns: as needed, with the widest reduced to fit."""
    least = [max(_LEAST, width(title)) for title in titles]
    widths = [min(_CELL, max([width(title), *(width(row[at]) for row in cells)])) for at, title in enumerate(titles)]
    while room > 0 and sum(widths) + _PADDING * len(widths) > room:
        spare, widest = max((wide - low, at) for at, (wide, low) in enumerate(zip(widths, least, strict=True)))
        if spare <= 0:
            break
        widths[widest] -= 1
    return widths


def _cut(text: str, room: int, term: Term | None) -> Text:
    """Return a text cut to the width of a cell; the end of a long IRI is kept."""
    # Every character has at least one column, so only a few of a long text are examined.
    at_end = isinstance(term, NamedNode)
    if len(text) > room:
        text = "…" + text[1 - room :] if at_end else text[: room - 1] + "…"
    while width(text) > room:
        text = "…" + text[2:] if at_end else text[:-2] + "…"
    return Text(text, no_wrap=True, end="")


def formats_of(result: Result) -> list[str]:
    """Return the formats for this kind of result, the most used first."""
    names = list(GRAPH_FORMATS if isinstance(result, Graph) else SOLUTION_FORMATS)
    if isinstance(result, Boolean):
        names = list(BOOLEAN_FORMATS)
    first = [name for name in ("tsv", "csv", "json", "markdown", "turtle") if name in names]
    return [*first, *(name for name in names if name not in first)]


def file_formats_of(result: Result) -> list[str]:
    """Return the formats of files: those of `formats_of`, and Parquet if it is supported."""
    return [*formats_of(result), *([parquet.NAME] if isinstance(result, Solutions) and parquet.is_installed() else [])]


def format_of_name(path: str, result: Result) -> str | None:
    """Return the format of a file name's suffix, None for an unknown one."""
    return next((name for name in file_formats_of(result) if path.lower().endswith(BY_NAME[name].ending)), None)


def copied(result: Result, name: str) -> str:
    """Return a result in the format `name`."""
    return write(result, name).decode("utf-8", errors="replace")


def is_taken(path: str) -> bool:
    """Return whether a file exists; UsageError KG553 if that cannot be determined."""
    with _reported(path):
        return Path(path).expanduser().exists()


def to_file(result: Result, path: str, name: str) -> int:
    """Write a result to a file and return the number of bytes; UsageError KG553 on failure."""
    content = write(result, name)
    with _reported(path):
        return Path(path).expanduser().write_bytes(content)


@contextmanager
def _reported(path: str) -> Iterator[None]:
    """Report path errors as KG553; the home of an unknown user is a RuntimeError."""
    try:
        yield
    except (OSError, RuntimeError, ValueError) as error:
        message = f"the file cannot be written: {getattr(error, 'strerror', None) or error}"
        raise UsageError("KG553", message, place=Place(path), hint="Name another file.") from error
