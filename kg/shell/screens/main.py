"""The main screen: tree, buffers with their running queries and results, and the status line."""

from __future__ import annotations

import re
import secrets
import time
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar, Final

from pyoxigraph import Literal, NamedNode
from textual import on
from textual.containers import Horizontal
from textual.events import DescendantBlur
from textual.screen import Screen
from textual.widgets import Footer, Static, TabbedContent, TextArea

from kg.errors import KgError
from kg.lazily import lazily
from kg.query.result import Boolean, Graph, Result, Solutions
from kg.query.statements import statement_at, statements
from kg.query.writing.values import display
from kg.render.text import count, printable
from kg.shell.actions import bindings
from kg.shell.buffers import Buffer, Buffers
from kg.shell.delivery import deliver, is_open
from kg.shell.editor import Completions, Problem, QueryEditor, begins_word
from kg.shell.results import AnswerTable, ResultView, columns_of, copied, formats_of, rows_of
from kg.shell.state import Entry, State
from kg.shell.tree import KnowledgeTree
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from pathlib import Path

    from textual.app import ComposeResult
    from textual.binding import BindingType
    from textual.timer import Timer

    from kg.query.readers.pool import Job
    from kg.shell.app import Shell
    from kg.shell.link import Link


with lazily():
    from kg.shell.screens.listing import ChoiceScreen, ExportScreen, HistoryScreen, JumpScreen, StoredScreen
    from kg.shell.screens.page import PageScreen, row_page, thing


class Runs:
    """Starts and stops the queries of a screen's buffers."""

    def __init__(self, screen: MainScreen) -> None:
        self._screen = screen
        self._link = screen.link
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
                _show_failure(buffer, error, text, offset, at_hand=self._is_at_hand(buffer, before))
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
        self._screen.state.remember(Entry(text, began, self._link.layout.name, rows, seconds, outcome))
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


def _show_failure(buffer: Buffer, error: KgError, text: str, offset: int, *, at_hand: bool) -> None:
    """Show an error and mark its place; move the cursor there if the user waits for it."""
    problem = _mark_of(error, text, offset)
    location = buffer.editor.location_at(problem.start) if problem else None
    buffer.results.show_error(error, location)
    if problem and location:
        if not any(one.start == problem.start for one in buffer.editor.problems):
            buffer.mark([problem])
        if at_hand:
            buffer.editor.move_cursor(location)
            buffer.editor.focus()


def _mark_of(error: KgError, text: str, offset: int) -> Problem | None:
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


_FOLLOW_SECONDS: Final = 2.0  # seconds between checks for a new generation of the store
_RUNNING_SECONDS: Final = 0.2
_TYPING_SECONDS: Final = 0.15  # seconds of a pause in typing before completions are requested
_CHECK_SECONDS: Final = 0.4


class Status(Static):
    """The status line."""

    def __init__(self, store: Path) -> None:
        super().__init__(markup=False)
        self._store = _short(store)
        self._snapshot: int | None = None
        self._work = ""
        self._note = ""

    def show_generation(self, snapshot: int | None, note: str = "") -> None:
        """Show the current generation of the store, None if it is missing, and what changed."""
        self._snapshot, self._note = snapshot, note
        self._draw()

    def run(self, job: Job | None) -> None:
        """Show the running work; None without any."""
        if job is None:
            self._work = ""
        else:
            progress = f", {count(job.rows, 'row')} so far" if job.rows else ""
            self._work = f"running {job.elapsed:.1f} s{progress} (Esc stops)"
        self._draw()

    def _draw(self) -> None:
        state = "store is gone" if self._snapshot is None else f"snapshot {self._snapshot}"
        parts = [self._work, self._note, state, self._store]
        self.update(printable("  ·  ".join(part for part in parts if part)))


def _short(path: Path) -> str:
    home = path.home()
    folder = path.parent if path.name == ".kg" else path
    return f"~/{folder.relative_to(home)}" if folder.is_relative_to(home) else str(folder)


async def diagnosed(link: Link, text: str) -> list[Problem]:
    """Return the problems of each query in a buffer; KgError if the store cannot be queried."""
    problems = []
    starts = [one.start for one in statements(text)]
    for begin, end in pairwise([*starts, len(text)]):
        answer = await link.call("diagnose", text=text[begin:end].rstrip())
        problems += [_problem(one, begin) for one in answer["problems"]]
    return problems


def _problem(problem: dict[str, Any], begin: int) -> Problem:
    words = ". ".join(str(problem[key]).rstrip(".") for key in ("message", "hint") if problem.get(key))
    fix = next(iter(problem["fixes"]), None)
    edits = tuple((begin + one["start"], begin + one["end"], one["text"]) for one in fix["edits"]) if fix else ()
    place = (begin + problem["start"], begin + problem["end"])
    return Problem(*place, problem["severity"], words, fix["title"] if fix else "", edits)


class MainScreen(Screen[None]):
    """The first screen of the shell."""

    app: Shell
    CONTEXTS = ("main", "editor", "results", "tree")
    BINDINGS: ClassVar[list[BindingType]] = bindings("main")
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (100, "-wide")]  # noqa: RUF012 - textual declares it without ClassVar

    def __init__(self, link: Link, state: State) -> None:
        super().__init__()
        self.link = link
        self.state = state
        self.runs = Runs(self)
        self._snapshot = link.snapshot()
        self._typing: Timer | None = None
        self._checking: Timer | None = None

    def compose(self) -> ComposeResult:
        """Yield the panels."""
        with Horizontal(id="panels"):
            yield KnowledgeTree(self.link)
            yield Buffers(self.state.buffers())
        yield Completions()
        yield Status(self.link.layout.root)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Focus the editor, and follow the store."""
        self.status.show_generation(self._snapshot)
        self.set_interval(_FOLLOW_SECONDS, self.follow)
        self.set_interval(_RUNNING_SECONDS, self.runs.show_status)
        self.call_after_refresh(self._begin)
        self._prepare()

    def _prepare(self) -> None:
        """Prepare the statistics for completion in the background, after the tree is loaded."""
        tree = self.query_one(KnowledgeTree)

        async def counted() -> None:
            await tree.begun.wait()
            await self.link.call("complete", fresh="yes")

        deliver(self, counted, lambda _: None, self._log_error)

    def _log_error(self, error: KgError) -> None:
        self.log(str(error))

    def _begin(self) -> None:
        if self.buffers.current:
            self.buffers.current.editor.focus()

    @property
    def buffers(self) -> Buffers:
        """The tabs."""
        return self.query_one(Buffers)

    @property
    def status(self) -> Status:
        """The status line."""
        return self.query_one(Status)

    @property
    def completions(self) -> Completions:
        """The list of completions."""
        return self.query_one(Completions)

    def keep(self) -> None:
        """Save the buffers for the next run."""
        self.state.keep_buffers(self.buffers.texts)

    def follow(self) -> None:
        """Detect that the store was rebuilt or removed."""
        generation = self.link.snapshot()
        if generation != self._snapshot:
            back, self._snapshot = self._snapshot is None, generation
            self.status.show_generation(generation, "" if generation is None or back else "the store was built again")
            if generation is not None:
                self.query_one(KnowledgeTree).reload()
                self._prepare()

    def action_run(self) -> None:
        """Run the selection, or the query at the cursor."""
        if self.buffers.current:
            self.runs.start_at_cursor(self.buffers.current)

    def action_run_buffer(self) -> None:
        """Run the buffer as one query."""
        if self.buffers.current:
            self.runs.start(self.buffers.current, self.buffers.current.text, 0)

    def stop(self) -> bool:
        """Stop the query of the visible buffer; return False if there is none."""
        return self.runs.stop(self.buffers.current)

    def action_stop(self) -> None:
        """Stop running work; otherwise leave full-screen results, and focus the editor."""
        if not self.stop() and self.buffers.current:
            self.remove_class("full")
            self.buffers.current.editor.focus()

    def action_next_problem(self) -> None:
        """Go to the next mark in the query."""
        if self.buffers.current:
            self.buffers.current.editor.focus()
            self.buffers.current.editor.go_to_next_problem()

    def action_fix(self) -> None:
        """Apply the fix at the cursor of the query."""
        if self.buffers.current:
            self.buffers.current.editor.focus()
            self.buffers.current.editor.fix()

    async def action_new_buffer(self) -> None:
        """Open an empty buffer."""
        await self.buffers.open("")

    async def action_close_buffer(self) -> None:
        """Close the buffer on the screen."""
        self.stop()
        await self.buffers.close_current()
        self.keep()

    def action_next_buffer(self) -> None:
        """Go right."""
        self.buffers.step(1)

    def action_previous_buffer(self) -> None:
        """Go left."""
        self.buffers.step(-1)

    def action_toggle_tree(self) -> None:
        """Show or hide the tree."""
        self.toggle_class("no-tree" if self.has_class("-wide") else "tree")
        tree = self.query_one(KnowledgeTree)
        left = tree.has_focus
        if tree.display:
            tree.focus()
        elif left and self.buffers.current:
            self.buffers.current.editor.focus()

    def action_toggle_results(self) -> None:
        """Maximise or restore the results."""
        self.toggle_class("full")
        if self.has_class("full") and self.buffers.current:
            self.buffers.current.results.table.focus()

    def action_history(self) -> None:
        """Choose from the history."""
        self.app.push_screen(HistoryScreen(self.state.history()), self._take)

    def action_stored(self) -> None:
        """Choose a stored query."""
        self.app.push_screen(StoredScreen(), self._take)

    def action_jump(self) -> None:
        """Go to a panel by its letter."""
        panels: dict[str, Any] = {"t": self.query_one(KnowledgeTree)}
        if self.buffers.current:
            panels |= {"e": self.buffers.current.editor, "r": self.buffers.current.results.table}
        shown = {key: widget for key, widget in panels.items() if widget.display and widget.region}
        self.app.push_screen(JumpScreen(shown), lambda widget: widget.focus() if widget else None)

    def _view(self) -> ResultView | None:
        buffer = self.buffers.current
        return buffer.results if buffer and buffer.results.result is not None else None

    @on(AnswerTable.Passed)
    def action_next_page(self) -> None:
        """Show the next page of rows."""
        if view := self._view():
            view.turn(1)

    def action_previous_page(self) -> None:
        """Show the page of rows before."""
        if view := self._view():
            view.turn(-1)

    def action_all_rows(self) -> None:
        """Request all rows of a limited result."""
        buffer = self.buffers.current
        view = self._view()
        if buffer and view and view.result and view.result.limit is not None:
            self.runs.start(buffer, buffer.last_query, max(buffer.text.find(buffer.last_query), 0), whole=True)

    def action_open_row(self) -> None:
        """Open the proof of the row."""
        view, buffer = self._view(), self.buffers.current
        row = view.row() if view else None
        if buffer is None or view is None or row is None or view.result is None:
            return
        query = buffer.last_query if isinstance(view.result, Solutions) else ""
        fact = row if isinstance(view.result, Graph) else None
        self.app.push_screen(PageScreen(row_page(columns_of(view.result), row, view.row_number(), query, fact)))

    def action_open_cell(self) -> None:
        """Open the thing in the cell."""
        cell = view.cell() if (view := self._view()) else None
        if isinstance(cell, NamedNode):
            self.app.push_screen(PageScreen(thing(cell.value, display(cell))))
        elif view:
            self.app.notify("The cell names no thing; Enter shows the whole row.", timeout=3)

    def action_edit_place(self) -> None:
        """Open the line of code of the row."""
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
        view, buffer = self._view(), self.buffers.current
        if buffer and view is not None and view.result is not None:
            self.app.push_screen(ExportScreen(view.result, buffer.last_query))

    def action_reload(self) -> None:
        """Reload the tree."""
        self.query_one(KnowledgeTree).reload()

    @on(KnowledgeTree.NodeSelected)
    def action_open_entry(self) -> None:
        """Open the page of the entry; folders expand and collapse."""
        tree = self.query_one(KnowledgeTree)
        entry = tree.entry
        if entry.get("iri"):
            self.app.push_screen(PageScreen(thing(entry["iri"], entry["label"])))
        elif tree.cursor_node:
            tree.cursor_node.toggle()

    def action_insert_entry(self) -> None:
        """Insert the name of the entry into the query."""
        iri = self.query_one(KnowledgeTree).entry.get("iri")
        buffer = self.buffers.current
        if iri and buffer:
            editor = buffer.editor
            editor.insert(shorten(iri))
            editor.focus()

    async def action_ask_entry(self) -> None:
        """Open a query for the facts about the entry."""
        entry = self.query_one(KnowledgeTree).entry
        if entry.get("iri"):
            text = f"# {entry['label']}\nSELECT ?property ?value {{ <{entry['iri']}> ?property ?value }}\n"
            await self.buffers.open(text)

    async def _take(self, text: str | None) -> None:
        if text:
            await self.buffers.open(text)

    @on(TextArea.Changed)
    def _changed(self, event: TextArea.Changed) -> None:
        if not isinstance(event.text_area, QueryEditor) or not is_open(event.text_area):
            return
        editor = event.text_area
        buffer = editor.query_ancestor(Buffer)
        self.buffers.name_tab(buffer)
        for timer in (self._typing, self._checking):
            if timer:
                timer.stop()
        line, column = editor.cursor_location
        if editor.has_focus and begins_word(editor.document.get_line(line)[:column]):
            self._typing = self.set_timer(_TYPING_SECONDS, lambda: self.offer(editor))
        else:
            self.completions.close()
        self._checking = self.set_timer(_CHECK_SECONDS, lambda: self.check_text(buffer))

    @on(TextArea.SelectionChanged)
    def _moved(self, event: TextArea.SelectionChanged) -> None:
        if isinstance(event.text_area, QueryEditor) and is_open(event.text_area):
            event.text_area.query_ancestor(Buffer).say_problem()

    @on(QueryEditor.CompletionKey)
    def _completion_key(self, event: QueryEditor.CompletionKey) -> None:
        self.completions.press(event.key)

    @on(QueryEditor.CompletionWanted)
    def _completion_wanted(self, event: QueryEditor.CompletionWanted) -> None:
        self.offer(event.editor)

    @on(Completions.OptionSelected)
    def _completion_clicked(self, event: Completions.OptionSelected) -> None:
        self.completions.insert(event.option_index)

    @on(TabbedContent.TabActivated)
    @on(DescendantBlur)
    def _hide_completions(self) -> None:
        self.completions.close()

    def offer(self, editor: QueryEditor) -> None:
        """Request completions at the cursor, unless its buffer has been closed."""
        if is_open(editor):
            self.completions.offer(editor, self.link)

    def check_text(self, buffer: Buffer) -> None:
        """Check a buffer, unless it has been closed; save all buffers in case the terminal closes."""
        self.keep()
        if is_open(buffer):
            text = buffer.text

            def mark(problems: list[Problem]) -> None:
                if buffer.text == text:
                    buffer.mark(problems)

            deliver(buffer, partial(diagnosed, self.link, text), mark, self._log_error, latest="check")
