"""Running queries: at most one per buffer, with progress and result."""

from __future__ import annotations

import re
import secrets
import time
from typing import TYPE_CHECKING

from kg.errors import KgError
from kg.query.result import Boolean, Result
from kg.query.statements import statement_at
from kg.shell.delivery import is_open
from kg.shell.editor import Problem
from kg.shell.results import rows_of
from kg.shell.state import Entry, State
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.shell.buffers import Buffer
    from kg.shell.link import Link
    from kg.shell.screens.main import MainScreen


class Runs:
    """Starts and stops the queries of a screen's buffers."""

    def __init__(self, screen: MainScreen, link: Link, state: State) -> None:
        self._screen = screen
        self._link = link
        self._state = state
        self._was_running = False

    def start_at_cursor(self, buffer: Buffer) -> None:
        """Run the selected text of a buffer, or the query at its cursor."""
        editor = buffer.editor
        if editor.selected_text.strip():
            self.start(buffer, editor.selected_text, editor.offset_at(min(editor.selection)))
            return
        statement = statement_at(buffer.text, editor.offset_of_cursor)
        if statement is None:
            self._screen.notify("This buffer has no query.", severity="warning", timeout=3)
        else:
            self.start(buffer, statement.text, statement.start)

    def start(self, buffer: Buffer, text: str, offset: int, *, whole: bool = False) -> None:
        """Run a query at `offset` of a buffer; `whole` removes the limit of rows."""
        if buffer.job is not None:
            self._screen.notify("A query of this buffer runs; Esc stops it.", severity="warning", timeout=3)
            return
        buffer.job = secrets.token_hex(8)
        buffer.results.say("running …")
        limit = None if whole else self._link.settings.limit or None
        self._screen.run_worker(self._run(buffer, text, offset, limit, _place(buffer)), group=buffer.job)

    def stop(self, buffer: Buffer | None) -> bool:
        """Stop the query of a buffer; return False if there is none."""
        return buffer is not None and buffer.job is not None and self._link.stop(buffer.job)

    def show_status(self) -> None:
        """Show running queries and their times in the status line."""
        buffer = self._screen.buffers.current
        job = self._link.job(buffer.job) if buffer and buffer.job else None
        if job or self._was_running:
            self._screen.status.run(job)
        self._was_running = job is not None

    async def _run(self, buffer: Buffer, text: str, offset: int, limit: int | None, before: tuple[str, object]) -> None:
        began, outcome, rows = time.time(), "ok", 0
        clock = time.perf_counter()
        job = buffer.job or ""
        buffer.last_query = text
        try:
            result = await self._link.ask(text, job=job, rows=limit)
        except KgError as error:
            outcome = error.code
            if is_open(buffer):
                _fail(buffer, error, text, offset, at_hand=self._is_at_hand(buffer, before))
        else:
            rows = len(rows_of(result))
            prefixes = await self._prefixes(text, result)
            if is_open(buffer):
                buffer.results.show(result, self._link.settings.base, prefixes)
                self._screen.check_text(buffer)  # marks of earlier errors are gone, hints about an empty result remain
                if (rows or isinstance(result, Boolean)) and self._is_at_hand(buffer, before):
                    buffer.results.table.focus()
        finally:
            buffer.job = None
        seconds = time.perf_counter() - clock
        self._state.remember(Entry(text, began, self._link.layout.name, rows, seconds, outcome))
        self._screen.keep()
        self.show_status()

    def _is_at_hand(self, buffer: Buffer, before: tuple[str, object]) -> bool:
        """Return whether the user waits for a result: after further typing, the focus stays in the editor."""
        return buffer is self._screen.buffers.current and _place(buffer) == before

    async def _prefixes(self, text: str, result: Result) -> dict[str, str]:
        """Return the prefixes that shorten a result: those of its query override others."""
        declared = {name: iri for name, iri in re.findall(r"(?i)\bPREFIX\s+([\w-]*):\s*<([^>]*)>", text) if iri}
        try:
            stored = await self._link.prefixes(result.snapshot)
        except KgError:
            stored = PREFIXES
        # Twice: they come first, so that a namespace with several prefixes gets theirs, and override those known.
        return {**declared, **stored, **declared}


def _place(buffer: Buffer) -> tuple[str, object]:
    """Return the selected text of a buffer with its place, or all of it with the cursor."""
    return buffer.text, buffer.editor.selection


def _fail(buffer: Buffer, error: KgError, text: str, offset: int, *, at_hand: bool) -> None:
    """Show an error and mark its place; move the cursor there if the user waits for it."""
    problem = _problem(error, text, offset)
    location = buffer.editor.location_at(problem.start) if problem else None
    buffer.results.show_error(error, location)
    if problem and location:
        if not any(one.start == problem.start for one in buffer.editor.problems):
            buffer.mark([problem])
        if at_hand:
            buffer.editor.move_cursor(location)
            buffer.editor.focus()


def _problem(error: KgError, text: str, offset: int) -> Problem | None:
    """Return the mark of an error about a query at `offset` of its buffer."""
    place = error.place
    if place is None or place.line is None or place.column is None:
        return None
    start = _offset(text, place.line, place.column)
    end = _offset(text, place.end_line, place.end_column) if place.end_line and place.end_column else start + 1
    words = f"{error.message}. {error.hint}" if error.hint else error.message
    return Problem(offset + start, offset + end, "error", words)


def _offset(text: str, line: int, column: int) -> int:
    lines = text.split("\n")
    return sum(len(one) + 1 for one in lines[: line - 1]) + column - 1
