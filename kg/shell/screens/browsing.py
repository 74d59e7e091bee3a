"""What can be done with an entry of the tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.screen import Screen

from kg.shell.buffers import Buffers
from kg.shell.tree import KnowledgeTree
from kg.syntax.names import shorten

if TYPE_CHECKING:
    from kg.shell.link import Link


class Browsing(Screen[None]):
    """The actions of the context `tree`, for the main screen."""

    link: Link

    def action_reload(self) -> None:
        """Read the tree again."""
        self.query_one(KnowledgeTree).reload()

    def action_open_entry(self) -> None:
        """Open the page of the entry; a folder opens and closes."""
        from kg.shell.screens.page import PageScreen, thing  # noqa: PLC0415 - start-up time

        tree = self.query_one(KnowledgeTree)
        entry = tree.entry
        if entry.get("iri"):
            self.app.push_screen(PageScreen(self.link, thing(entry["iri"], entry["label"])))
        elif tree.cursor_node:
            tree.cursor_node.toggle()

    def action_insert_entry(self) -> None:
        """Put the name of the entry into the query."""
        iri = self.query_one(KnowledgeTree).entry.get("iri")
        buffer = self.query_one(Buffers).current
        if iri and buffer:
            editor = buffer.editor
            editor.insert(shorten(iri))
            editor.focus()

    async def action_ask_entry(self) -> None:
        """Write a query for the facts about the entry."""
        entry = self.query_one(KnowledgeTree).entry
        if entry.get("iri"):
            text = f"# {entry['label']}\nSELECT ?property ?value {{ <{entry['iri']}> ?property ?value }}\n"
            await self.query_one(Buffers).open(text)
