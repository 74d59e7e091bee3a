"""Search: a query in words, matching nodes, and reasons."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from textual import on
from textual.widgets import Footer, Input, Static

from kg.render.text import count, printable
from kg.shell.delivery import deliver
from kg.shell.screens.base import UpperScreen
from kg.shell.screens.page import Line, LineTree, PageScreen, thing

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.events import Key

    from kg.errors import KgError

_SHOWN = 30


class HitTree(LineTree, context="find"):
    """The hits, each with its reasons below it."""


class FindScreen(UpperScreen[None], context="find"):
    """Requests the view `find`, and opens its results."""

    def compose(self) -> ComposeResult:
        """Yield the input, the interpretation, and the hits."""
        yield Input(placeholder="what you need, for example: stop before an obstacle with a laser scanner")
        yield Static("Enter: search. Down: results.", classes="hint", markup=False)
        yield HitTree()
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Focus the input."""
        self.query_one(Input).focus()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Search."""
        if event.value.strip():
            self._hint("searching …")
            request = partial(self.app.link.call, "find", text=event.value, limit=str(_SHOWN))
            deliver(self, request, self._answer, self._fail, latest="find")

    def on_key(self, event: Key) -> None:
        """Move between the input and the hits."""
        tree = self.query_one(HitTree)
        if event.key == "down" and isinstance(self.focused, Input) and tree.root.children:
            event.stop()
            tree.focus()
        elif event.key == "up" and self.focused is tree and tree.cursor_line <= 0:
            event.stop()
            self.query_one(Input).focus()

    def _answer(self, answer: dict[str, Any]) -> None:
        tree = self.query_one(HitTree)
        self._hint(_understood(answer))
        tree.fill([_hit(one) for one in answer["hits"]])
        if answer["hits"]:
            tree.cursor_line = 0
            tree.focus()

    def _fail(self, error: KgError) -> None:
        self._hint(f"{error.code}: {error.message} {error.hint or ''}")

    def _hint(self, words: str) -> None:
        self.query_one(".hint", Static).update(printable(words))

    @on(HitTree.NodeSelected)
    def action_open_hit(self) -> None:
        """Open the page of the selected line's node."""
        node = self.query_one(HitTree).cursor_node
        line = node.data if node else None
        if line is not None and not line.iri and node and node.parent:
            line = node.parent.data
        if line is not None and line.iri:
            self.app.push_screen(PageScreen(thing(line.iri, line.text)))

    def action_edit_place(self) -> None:
        """Open the line of code."""
        line = self.query_one(HitTree).current()
        self.app.edit(line.place if line else None)


def _understood(answer: dict[str, Any]) -> str:
    if not answer["hits"]:
        return f"Nothing was found. {answer['near'] or 'Use other words.'}"
    shown = len(answer["hits"])
    words = [f"{count(answer['total'], 'node')}, {shown} shown" if answer["total"] > shown else count(shown, "node")]
    if not answer["fits"]:
        words.insert(0, "nothing here fits, nearest are below")
    words += answer["unknown"]
    for key, phrase in (("only", "only with"), ("rather", "rather with")):
        if answer[key]:
            words.append(f"{phrase} {', '.join(answer[key])}")
    return "; ".join(words)


def _hit(one: dict[str, Any]) -> Line:
    reasons = tuple(Line(reason["text"], place=reason["evidence"]) for reason in one["reasons"])
    also = f"and {count(len(one['also']), 'other')} like it" if one["also"] else ""
    title = f"{one['rank']}. {one['package']}/{one['name']}"
    return Line(title, iri=one["iri"], place=one["evidence"], note=also, children=reasons)
