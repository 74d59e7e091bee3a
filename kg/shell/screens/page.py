"""Pages of rows, things, nodes and proofs: trees of lines with links."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

from pyoxigraph import BlankNode, NamedNode
from rich.text import Text
from textual.widgets import Footer, Static, Tree

from kg.query.formats import display
from kg.render.text import printable
from kg.shell.delivery import deliver
from kg.shell.pages import (
    Line,
    Page,
    lines_of_node,
    lines_of_proof,
    lines_of_resource,
    lines_of_row,
    place_words,
    title_of,
)
from kg.shell.screens.base import Acting, UpperScreen

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from textual.app import ComposeResult
    from textual.widgets.tree import TreeNode

    from kg.errors import KgError
    from kg.shell.link import Link
    from kg.store.terms import Term

_Lines: TypeAlias = "Callable[[Mapping[str, Any]], tuple[Line, ...]]"
_LINES: dict[str, _Lines] = {
    "node": lines_of_node,
    "resource": lines_of_resource,
    "why": lines_of_proof,
    "why_row": lines_of_row,
}


def thing(iri: str, title: str) -> Page:
    """Return the page of a thing with this IRI."""
    view = "node" if "/node/" in iri and "#" not in iri else "resource"
    return Page(title, view, {"iri": iri}, query=f"SELECT ?property ?value {{ <{iri}> ?property ?value }}\n")


def proof_page(fact: tuple[str, str, str], title: str) -> Page:
    """Return the page of the proof of a fact."""
    subject, predicate, value = fact
    query = f"ASK {{ {subject} {predicate} {value} }}\n"
    return Page(f"Why: {title}", "why", {"subject": subject, "predicate": predicate, "object": value}, query=query)


def row_page(
    columns: Sequence[str], row: Sequence[Term | None], number: int, query: str, fact: Sequence[Term | None] | None
) -> Page:
    """Return the page of a row: its cells, and its proof; `fact` if the row is a triple of a graph."""
    lines = tuple(
        Line(f"{name} = {display(term)}", iri=term.value if isinstance(term, NamedNode) else "")
        for name, term in zip(columns, row, strict=True)
        if term is not None
    )
    title = f"Row {number}"
    if fact is not None:
        subject, predicate, value = (str(term) for term in fact)
        return Page(title, "why", {"subject": subject, "predicate": predicate, "object": value}, lines, query)
    bound = {
        name: str(term)
        for name, term in zip(columns, row, strict=True)
        if term is not None and not isinstance(term, BlankNode)
    }
    return Page(title, "why_row", {"query": query, "row": bound}, lines, query)


class LineTree(Acting, Tree[Line]):
    """A tree of lines; Space expands and collapses a line."""

    def __init__(self, label: str = "") -> None:
        super().__init__(label)
        self.show_root = False
        self.auto_expand = False

    def fill(self, lines: Sequence[Line]) -> None:
        """Show these lines."""
        self.clear()
        _add(self.root, lines)
        self.root.expand()

    def current(self) -> Line | None:
        """Return the line under the cursor."""
        return self.cursor_node.data if self.cursor_node else None


def _add(parent: TreeNode[Line], lines: Sequence[Line]) -> None:
    for line in lines:
        if line.children:
            _add(parent.add(_label(line), line, expand=line.open), line.children)
        else:
            parent.add_leaf(_label(line), line)


def _label(line: Line) -> Text:
    """Return the text of a line; colours carry no extra meaning."""
    parts: list[Any] = [printable(line.text)]
    if line.mark:
        parts += ["  ", (f"({line.mark})", "italic")]
    if line.place:  # by the name of its file; the status line has the whole path
        name = place_words(line.place).rpartition("/")[2]
        parts += ["  ", (f"▸ {printable(name)}", "underline")]
    if line.note:  # last, since it may be wider than the screen
        parts += ["  ", (printable(line.note), "dim")]
    return Text.assemble(*parts, no_wrap=True)


class PageTree(LineTree, context="page"):
    """The lines of a page, with its keys."""


class PageScreen(UpperScreen[None], context="page"):
    """One page, and those reached from it."""

    def __init__(self, link: Link, page: Page) -> None:
        super().__init__()
        self._link = link
        self._page = page
        self._before: list[Page] = []

    def compose(self) -> ComposeResult:
        """Yield title, lines and footer."""
        yield Static("", classes="title", markup=False)
        yield PageTree("")
        yield Static("", classes="problem", markup=False)
        yield Static("", classes="detail", markup=False)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Show the page."""
        self.query_one(LineTree).focus()
        self.show(self._page)

    def show(self, page: Page) -> None:
        """Show a page: available data at once, then the store's result."""
        self._page = page
        self.query_one(".title", Static).update(printable(page.title))
        self.query_one(LineTree).fill(page.lines or (Line("reading …"),))
        self._problem("")
        self.workers.cancel_node(self)  # the result of the previous page
        if page.view:
            request = partial(self._link.call, page.view, **page.arguments)
            deliver(self, request, partial(self._answer, page), partial(self._fail, page))

    def _answer(self, page: Page, data: dict[str, Any]) -> None:
        tree = self.query_one(LineTree)
        tree.fill((*page.lines, *_LINES[page.view](data)))
        tree.cursor_line = 0
        if title := title_of(page.view, data):
            self.query_one(".title", Static).update(printable(title))

    def _fail(self, page: Page, error: KgError) -> None:
        if not page.lines:
            self.query_one(LineTree).fill(())
        self._problem(f"{error.code}: {error.message}" + (f"\n{error.hint}" if error.hint else ""))

    def on_tree_node_highlighted(self, event: Tree.NodeHighlighted[Line]) -> None:
        """Show the full text of the line under the cursor."""
        line = event.node.data
        if line is not None:
            parts = [line.text, line.note, place_words(line.place), line.iri]
            words = "\n".join(printable(part) for part in parts if part)
            self.query_one(".detail", Static).update(words)

    def _problem(self, words: str) -> None:
        line = self.query_one(".problem", Static)
        line.update(printable(words) if "\n" not in words else words)
        line.display = bool(words)

    def follow(self, page: Page) -> None:
        """Go to a page, keeping the current one in the history."""
        self._before.append(self._page)
        self.show(page)

    def on_tree_node_selected(self, event: Tree.NodeSelected[Line]) -> None:
        """Follow the line's link."""
        event.stop()
        self.action_follow()

    def action_follow(self) -> None:
        """Open the line's thing; without one, its place or its children."""
        tree = self.query_one(LineTree)
        line = tree.current()
        if line is None:
            return
        if line.iri:
            self.follow(thing(line.iri, line.text))
        elif line.fact and self._page.view != "why":
            self.action_why()
        elif line.children and tree.cursor_node:
            tree.cursor_node.toggle()
        elif line.place:
            self.app.edit(line.place)

    def action_edit_place(self) -> None:
        """Open the line of code."""
        line = self.query_one(LineTree).current()
        self.app.edit(line.place if line else None)

    def action_why(self) -> None:
        """Show the proof of the line's fact."""
        line = self.query_one(LineTree).current()
        if line and line.fact:
            self.follow(proof_page(line.fact, line.text))
        else:
            self.notify("No proof for this line. Lines marked (inferred) have one.", timeout=4)

    def action_copy_entry(self) -> None:
        """Copy the name of the line."""
        if line := self.query_one(LineTree).current():
            self.app.copy(line.iri or line.text, "the line")

    async def action_ask_page(self) -> None:
        """Open a query for these facts in a buffer."""
        if self._page.query:
            self.dismiss()
            await self.app.main.buffers.open(self._page.query)

    def action_back(self) -> None:
        """Go back to the previous page, or to the screen below."""
        if self._before:
            self.show(self._before.pop())
        else:
            self.dismiss()
