"""The query editor: syntax colours, marks of problems, its keys, and the list of completions at the cursor.

Colours are spans of the text with a style class, from the same tokens that guards check.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Final, NamedTuple

from rich.style import Style
from rich.text import Text
from textual.geometry import Offset, Region
from textual.message import Message
from textual.widgets import TextArea
from textual.widgets.option_list import Option
from textual.widgets.text_area import TextAreaTheme

from kg.query.statements import Statement, segment_at
from kg.render.text import printable
from kg.shell.actions import bindings
from kg.shell.delivery import deliver
from kg.shell.screens.listing import MOVES, Options
from kg.syntax.lexer import Kind, normalise, tokens

if TYPE_CHECKING:
    from collections.abc import Iterator

    from textual.binding import BindingType
    from textual.events import Key
    from textual.strip import Strip

    from kg.shell.link import Link


_COMPLETING: Final = ("up", "down", "enter", "tab", "escape", "pageup", "pagedown")
"""Keys for the list of completions while it is open."""
_COMMENT: Final = "# "
_PLACEHOLDER: Final = "Type a query in SPARQL.\nF3 has stored ones, F2 finds nodes by what they do, F1 shows every key."
_THEME: Final = TextAreaTheme("sparql", cursor_line_style=Style())
"""A style for the cursor's line would hide syntax colours; only its number is marked."""

CLASSES: Final = ("comment", "iri", "string", "variable", "name", "keyword", "number")
"""Kinds of spans; `sparql--KIND` is the class of the style."""

_KINDS: Final = {
    Kind.IRI: "iri",
    Kind.STRING: "string",
    Kind.VARIABLE: "variable",
    Kind.NAME: "name",
    Kind.WORD: "keyword",
    Kind.NUMBER: "number",
    Kind.TAG: "string",
}
_COMMENTS: Final = re.compile(r"#[^\n]*")


class Span(NamedTuple):
    """A span of a text with its kind."""

    start: int
    end: int
    kind: str


def spans(text: str) -> Iterator[Span]:
    """Yield the coloured spans of a normalised query, in order; comments are between tokens."""
    position = 0
    for token in tokens(text):
        yield from _comments(text, position, token.start)
        position = token.end
        if token.kind in _KINDS:
            yield Span(token.start, token.end, _KINDS[token.kind])
    yield from _comments(text, position, len(text))


def _comments(text: str, start: int, end: int) -> Iterator[Span]:
    for match in _COMMENTS.finditer(text, start, end):
        yield Span(match.start(), match.end(), "comment")


def line_starts(text: str) -> list[int]:
    """Return the offset of the first character of each line."""
    return [0, *(match.end() for match in re.finditer("\n", text))]


def line_spans(text: str) -> dict[int, list[Span]]:
    """Return the spans by line, with columns instead of offsets; spans of several lines are split."""
    starts = line_starts(text)
    by_line: dict[int, list[Span]] = {}
    for span in spans(text):
        line = bisect_right(starts, span.start) - 1
        while line < len(starts) and starts[line] < span.end:
            end = starts[line + 1] - 1 if line + 1 < len(starts) else len(text)
            part = Span(max(span.start - starts[line], 0), min(span.end, end) - starts[line], span.kind)
            by_line.setdefault(line, []).append(part)
            line += 1
    return by_line


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem between two offsets of the text; `edits` (start, end, text) fix it, `fix` describes the fix."""

    start: int
    end: int
    severity: str
    message: str
    fix: str = ""
    edits: tuple[tuple[int, int, str], ...] = ()


class QueryEditor(TextArea):
    """A buffer's text; `problems` are marked in it."""

    BINDINGS: ClassVar[list[BindingType]] = bindings("editor")
    COMPONENT_CLASSES: ClassVar[set[str]] = {f"sparql--{kind}" for kind in (*CLASSES, "error", "warning")}

    class CompletionKey(Message):
        """A key for the list of completions."""

        def __init__(self, key: str) -> None:
            self.key = key
            super().__init__()

    class CompletionWanted(Message):
        """Completions were requested by key."""

        def __init__(self, editor: QueryEditor) -> None:
            self.editor = editor
            super().__init__()

    def __init__(self, text: str = "", **more: Any) -> None:
        super().__init__(
            text,
            placeholder=_PLACEHOLDER,
            show_line_numbers=True,
            soft_wrap=False,
            tab_behavior="indent",
            highlight_cursor_line=True,
            **more,
        )
        self.register_theme(_THEME)
        self.theme = _THEME.name
        self.indent_width = 2
        self.problems: list[Problem] = []
        self.completing = False
        """Whether the list of completions is open, which then handles some keys."""
        self._painted: str | None = None
        self._spans: dict[int, list[Span]] = {}
        self._starts: list[int] = [0]

    @property
    def offset_of_cursor(self) -> int:
        """Number of characters before the cursor."""
        return self.offset_at(self.cursor_location)

    def offset_at(self, location: tuple[int, int]) -> int:
        """Return the number of characters before a line and column, counting one per line end."""
        line, column = location
        return sum(len(self.document.get_line(one)) + 1 for one in range(line)) + column

    def location_at(self, offset: int) -> tuple[int, int]:
        """Return the line and column of an offset."""
        starts = line_starts(normalise(self.text))
        line = bisect_right(starts, offset) - 1
        return line, offset - starts[line]

    def mark(self, problems: list[Problem]) -> None:
        """Set the marked problems."""
        self.problems = problems
        self.notify_style_update()
        self.refresh()

    def problem_at_cursor(self) -> Problem | None:
        """Return the problem under the cursor, else the first of its line."""
        offset, line = self.offset_of_cursor, self.cursor_location[0]
        at = [one for one in self.problems if one.start <= offset <= one.end]
        near = [one for one in self.problems if self.location_at(one.start)[0] == line]
        return next(iter([*at, *near]), None)

    def action_complete(self) -> None:
        """Request completions at the cursor."""
        self.post_message(self.CompletionWanted(self))

    def action_comment(self) -> None:
        """Comment out the selected lines, or uncomment them if all are comments."""
        first, last = sorted((self.selection.start[0], self.selection.end[0]))
        lines = [self.document.get_line(number) for number in range(first, last + 1)]
        if all(line.lstrip().startswith("#") or not line.strip() for line in lines):
            changed = [
                line.replace(_COMMENT, "", 1) if _COMMENT in line else line.replace("#", "", 1) for line in lines
            ]
        else:
            changed = [_COMMENT + line for line in lines]
        self.replace("\n".join(changed), (first, 0), (last, len(lines[-1])))

    def go_to_next_problem(self) -> None:
        """Go to the next problem, wrapping around."""
        if self.problems:
            offset = self.offset_of_cursor
            following = [one for one in self.problems if one.start > offset]
            self.move_cursor(self.location_at((following or self.problems)[0].start))

    def fix(self) -> None:
        """Apply the fix of the problem under the cursor, if there is one."""
        problem = self.problem_at_cursor()
        for start, end, text in sorted(problem.edits if problem else (), reverse=True):
            self.replace(text, self.location_at(start), self.location_at(end))

    def scroll_cursor_visible(self, center: bool = False, animate: bool = False) -> Offset:  # noqa: FBT001, FBT002 - as in textual
        """Scroll to the cursor, if its line exists: undo updates the scroll bars before the cursor."""
        if self.cursor_location[0] >= self.document.line_count:
            return Offset()
        return super().scroll_cursor_visible(center, animate)

    async def action_leave(self) -> None:
        """Exit the shell from an empty buffer; otherwise delete forwards."""
        if self.text:
            self.action_delete_right()
        else:
            await self.app.run_action("app.quit")

    async def _on_key(self, event: Key) -> None:
        if self.completing and event.key in _COMPLETING:
            event.stop()
            event.prevent_default()
            self.post_message(self.CompletionKey(event.key))
        elif event.key == "escape":
            event.prevent_default()

    def render_lines(self, crop: Region) -> list[Strip]:
        """Render with the current colours."""
        text = normalise(self.text)
        if text != self._painted:
            self._painted, self._spans, self._starts = text, line_spans(text), line_starts(text)
        return super().render_lines(crop)

    def get_line(self, line_index: int) -> Text:
        """Return a line with its colours and marks."""
        line = super().get_line(line_index)
        for span in self._spans.get(line_index, ()):
            line.stylize(self.get_component_rich_style(f"sparql--{span.kind}", partial=True), span.start, span.end)
        start = self._starts[line_index] if line_index < len(self._starts) else 0
        for problem in self.problems:
            first, last = max(problem.start - start, 0), min(max(problem.end, problem.start + 1) - start, len(line) + 1)
            if first < last:
                if last > len(line):
                    line.pad_right(1)
                style = "error" if problem.severity == "error" else "warning"
                line.stylize(self.get_component_rich_style(f"sparql--{style}", partial=True), first, last)
        return line


_MOST: Final = 100
_WORD_BEGINS: Final = "?$:_"


def begins_word(text: str) -> bool:
    """Return whether typed text is part of a word, for which completions open automatically."""
    return bool(text) and (text[-1].isalnum() or text[-1] in _WORD_BEGINS)


class Completions(Options):
    """Completions at the cursor of `editor`; visible only while there is a choice."""

    can_focus = False

    def __init__(self) -> None:
        super().__init__()
        self._items: list[dict[str, Any]] = []
        self._editor: QueryEditor | None = None
        self._text = ""
        """The text of the list; after more typing a newer list is requested."""
        self._base = 0
        self._range = (0, 0)

    def offer(self, editor: QueryEditor, link: Link) -> None:
        """Request completions and show them, unless the text has changed since."""
        text, offset = editor.text, editor.offset_of_cursor
        part = segment_at(text, offset)
        request = partial(link.call, "complete", text=part.text, position=offset - part.start)
        show = partial(self._show, editor, text, offset, part)
        deliver(editor, request, show, lambda error: self.log(str(error)), latest="complete")

    def _show(self, editor: QueryEditor, text: str, offset: int, part: Statement, answer: dict[str, Any]) -> None:
        if (editor.text, editor.offset_of_cursor) != (text, offset) or not editor.has_focus:
            return
        self._editor, self._text = editor, text
        self._items = answer["items"][:_MOST]
        self._base = part.start
        self._range = (part.start + answer["range"]["start"], part.start + answer["range"]["end"])
        typed = text[slice(*self._range)]
        if not self._items or [item["insert"] for item in self._items] == [typed]:
            self.close()
            return
        self.clear_options()
        wide = max(len(item["label"]) for item in self._items)
        for item in self._items:
            detail = printable(" ".join(str(item[key]) for key in ("kind", "detail") if item.get(key)))
            self.add_option(Option(Text.assemble(printable(item["label"]).ljust(wide), "  ", (detail, "dim"))))
        self.highlighted = 0
        self.absolute_offset = editor.cursor_screen_offset + Offset(0, 1)
        self.display = True
        editor.completing = True

    def close(self) -> None:
        """Hide the list."""
        self.display = False
        if self._editor is not None:
            self._editor.completing = False

    def press(self, key: str) -> None:
        """Handle a key of the editor: move in the list, accept, or close it."""
        if key in MOVES:
            getattr(self, f"action_{MOVES[key]}")()
        elif key == "escape" or self.highlighted is None:
            self.close()
        elif self._editor is not None and self._editor.text != self._text:
            self.close()
            if key == "enter":
                self._editor.insert("\n")
        else:
            self.insert(self.highlighted)

    def insert(self, number: int) -> None:
        """Replace the typed prefix with a completion, and apply its other edits."""
        editor = self._editor
        self.close()
        if editor is None or number >= len(self._items):
            return
        item = self._items[number]
        begin, end = self._range
        changes = [(self._base + one["start"], self._base + one["end"], one["text"]) for one in item["edits"]]
        for start, stop, text in sorted([*changes, (begin, end, item["insert"])], reverse=True):
            editor.replace(text, editor.location_at(start), editor.location_at(stop), maintain_selection_offset=False)
        before = sum(len(text) - (stop - start) for start, stop, text in changes if start < begin)
        behind = item["holes"][0] if item["holes"] else len(item["insert"])
        editor.move_cursor(editor.location_at(begin + before + behind))
