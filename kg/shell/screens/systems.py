"""Launch configurations, with the findings of `kg lint` for each."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from textual.containers import Horizontal, Vertical
from textual.widgets import Footer, Static, Tree

from kg.render.text import count, printable
from kg.shell.delivery import deliver
from kg.shell.screens.base import UpperScreen
from kg.shell.screens.page import Line, LineTree, PageScreen, lines_of_system, place_words, proof_page, thing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual.app import ComposeResult


_PART = 500  # maximum number of configurations per request


class FindingTree(LineTree, context="systems"):
    """The nodes and findings of a configuration."""


class SystemsScreen(UpperScreen[None], context="systems"):
    """The views `systems`, `tree` and `lint`."""

    def compose(self) -> ComposeResult:
        """Yield configurations and findings."""
        yield Static("Systems: reading …", classes="title", markup=False)
        with Horizontal():
            tree: Tree[dict[str, Any]] = Tree("systems", id="system-tree")
            tree.show_root = False
            yield tree
            with Vertical():
                yield FindingTree()
                yield Static("", classes="detail", markup=False)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Request the configurations."""
        self.query_one("#system-tree").focus()
        self._read(0)

    def _read(self, begin: int) -> None:
        request = partial(self.app.link.call, "systems", offset=str(begin), limit=str(_PART))
        deliver(self, request, partial(self._answer, begin), self.app.report)

    def _answer(self, begin: int, answer: dict[str, Any]) -> None:
        tree: Tree[dict[str, Any]] = self.query_one("#system-tree", Tree)
        for one in answer["systems"]:
            wrong = [count(number, severity) for severity, number in one["findings"].items() if number]
            numbers = ", ".join([count(one["nodes"], "node"), *wrong])
            tree.root.add_leaf(printable(f"{one['name']}  {numbers}"), one)
        tree.root.expand()
        tree.cursor_line = max(tree.cursor_line, 0)
        if begin + _PART < answer["total"]:
            self._read(begin + _PART)
        else:
            self.query_one(".title", Static).update(f"Systems: {count(answer['total'], 'launch configuration')}")

    def on_tree_node_highlighted(self, event: Tree.NodeHighlighted[Any]) -> None:
        """Show the content of a configuration, or the full text of a finding."""
        data = event.node.data
        if event.control.id == "system-tree":
            if data:
                tree = self.query_one(FindingTree)
                deliver(self, partial(self._lines, data), tree.fill, self.app.report, latest="system")
        elif data is not None:
            parts = [data.text, data.note, place_words(data.place)]
            self.query_one(".detail", Static).update("\n".join(printable(part) for part in parts if part))

    async def _lines(self, system: dict[str, Any]) -> Sequence[Line]:
        below = await self.app.link.call("tree", parent=system["iri"])
        findings = await self.app.link.call("lint", system=system["iri"])
        return lines_of_system(system, below["children"], findings)

    def on_tree_node_selected(self, event: Tree.NodeSelected[Any]) -> None:
        """Go to the findings; from a finding to its subject, or its proof."""
        tree = self.query_one(FindingTree)
        line = event.node.data
        if event.control is not tree:
            tree.focus()
        elif line is None:
            return
        elif line.fact:
            self.app.push_screen(PageScreen(proof_page(line.fact, line.text)))
        elif line.iri:
            self.app.push_screen(PageScreen(thing(line.iri, line.text)))
        else:
            event.node.toggle()

    def action_edit_place(self) -> None:
        """Open the line of code."""
        line = self.query_one(FindingTree).current()
        self.app.edit(line.place if line else None)
