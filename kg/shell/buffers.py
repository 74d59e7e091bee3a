"""The tabs: each has a query, a line about its problems, and its result."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from textual.css.query import NoMatches
from textual.widgets import Static, TabbedContent, TabPane

from kg.render.text import count, printable
from kg.shell.editor import Problem, QueryEditor
from kg.shell.results import ResultView
from kg.syntax.lexer import normalise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual.app import ComposeResult

_TITLE: Final = 18  # maximum characters of a tab's title


class Buffer(TabPane):
    """A query with its result; `job` identifies a running query, `last_query` is the text of the result's query."""

    def __init__(self, number: int, text: str) -> None:
        super().__init__(_title(number, text), id=f"buffer-{number}")
        self.number = number
        self.job: str | None = None
        self.last_query = ""
        self._first_text = text

    def compose(self) -> ComposeResult:
        """Yield editor, remark and answer."""
        yield QueryEditor(self._first_text)
        yield Static("", classes="problem", markup=False)
        yield ResultView()

    @property
    def editor(self) -> QueryEditor:
        """The query."""
        return self.query_one(QueryEditor)

    @property
    def results(self) -> ResultView:
        """The answer."""
        return self.query_one(ResultView)

    @property
    def text(self) -> str:
        """The query with line feeds as line ends; empty once the editor is removed."""
        editors = self.query(QueryEditor)
        if editors:
            return normalise(editors.first().text)
        return "" if self.is_mounted else self._first_text

    @property
    def title(self) -> str:
        """The title of the tab."""
        return _title(self.number, self.text)

    def mark(self, problems: list[Problem]) -> None:
        """Mark problems in the query and show the one under the cursor."""
        self.editor.mark(problems)
        self.say_problem()

    def say_problem(self) -> None:
        """Show the problem under the cursor, or the number of problems elsewhere."""
        editor, line = self.editor, self.query_one(".problem", Static)
        problem = editor.problem_at_cursor()
        others = len(editor.problems)
        words = f"{count(others, 'problem')} marked (Ctrl+G: next problem)"
        if problem:
            fix = f" (Ctrl+F: {problem.fix})" if problem.fix else ""
            words = f"{problem.severity}: {problem.message}{fix}"
        line.update(printable(words) if editor.problems else "")
        line.display = bool(editor.problems)


class Buffers(TabbedContent):
    """All buffers, at least one."""

    def __init__(self, texts: Sequence[str]) -> None:
        super().__init__()
        self._texts = list(texts) or [""]
        self._number = 0

    def compose(self) -> ComposeResult:
        """Yield the tabs with the saved buffers."""
        for text in self._texts:
            self._tab_content.append(self._create(text))
        yield from super().compose()

    def _create(self, text: str) -> Buffer:
        self._number += 1
        return Buffer(self._number, text)

    @property
    def all(self) -> list[Buffer]:
        """The buffers from left to right."""
        return list(self.query(Buffer))

    @property
    def current(self) -> Buffer | None:
        """The visible buffer; None while tabs are added or removed."""
        try:
            pane = self.active_pane
        except NoMatches:
            return None
        return pane if isinstance(pane, Buffer) else None

    @property
    def texts(self) -> list[str]:
        """The queries, without empty buffers."""
        return [text for one in self.all if (text := one.text).strip()]

    async def open(self, text: str) -> None:
        """Open a buffer and show it; an empty visible one is reused."""
        buffer = self.current
        if buffer is not None and not buffer.text.strip() and buffer.job is None:
            buffer.editor.text = text
        else:
            buffer = self._create(text)
            await self.add_pane(buffer)
            self.active = str(buffer.id)
        buffer.editor.focus()

    async def close_current(self) -> None:
        """Close the visible buffer; the last one is emptied."""
        current = self.current
        if current is None:
            return
        if len(self.all) == 1:
            current.editor.text = ""
            return
        self.step(1)
        await self.remove_pane(str(current.id))
        if self.current:
            self.current.editor.focus()

    def step(self, by: int) -> None:
        """Show the buffer that many tabs to the right, wrapping around."""
        buffers = self.all
        current = self.current
        if current in buffers:
            aim = buffers[(buffers.index(current) + by) % len(buffers)]
            self.active = str(aim.id)
            aim.editor.focus()

    def name_tab(self, buffer: Buffer) -> None:
        """Set the title of a buffer's tab."""
        tab = self.get_tab(buffer)
        if str(tab.label) != buffer.title:
            tab.label = buffer.title


def _title(number: int, text: str) -> str:
    """Return the title of a buffer: its first comment, or its columns."""
    lines = [line.strip() for line in text.splitlines() if line.strip("# \t")]
    first = next((line for line in lines if not line.lower().startswith(("prefix ", "base "))), "")
    words = printable(re.sub(r"\s+", " ", first.lstrip("# ")))
    words = re.sub(r"[\[\]]", "", words)
    return f"{number} {words if len(words) <= _TITLE else words[: _TITLE - 1] + '…'}".strip()
