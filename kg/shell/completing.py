"""The list of completions at the cursor."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Final

from rich.text import Text
from textual.geometry import Offset
from textual.widgets.option_list import Option

from kg.query.statements import Statement, segment_at
from kg.render.text import printable
from kg.shell.delivery import deliver
from kg.shell.screens.listing import MOVES, Options

if TYPE_CHECKING:
    from kg.shell.editor import QueryEditor
    from kg.shell.link import Link

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
