"""Rules by family, each with its documentation and its effect in the last run."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from textual.containers import Horizontal, VerticalScroll
from textual.widgets import Footer, Markdown, Static, Tree

from kg.render.text import count, printable
from kg.shell.delivery import deliver
from kg.shell.screens.base import UpperScreen

if TYPE_CHECKING:
    from textual.app import ComposeResult


class RulesScreen(UpperScreen[None], context="rules"):
    """The rules of the view `rules`."""

    def compose(self) -> ComposeResult:
        """Yield the families and the page of a rule."""
        yield Static("Rules: reading …", classes="title", markup=False)
        with Horizontal():
            tree: Tree[dict[str, Any]] = Tree("rules", id="rule-tree")
            tree.show_root = False
            yield tree
            with VerticalScroll(id="rule-page"):
                yield Markdown("Choose a rule.")
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Request the rules."""
        self.query_one(Tree).focus()
        deliver(self, partial(self.app.link.call, "rules"), self._answer, self.app.report)

    def _answer(self, answer: dict[str, Any]) -> None:
        tree: Tree[dict[str, Any]] = self.query_one(Tree)
        for family in answer["families"]:
            state = "" if family["in_force"] else " (not in force)"
            branch = tree.root.add(f"{family['family']} {len(family['rules'])}{state}", {})
            for rule in family["rules"]:
                branch.add_leaf(printable(rule["rule"].rpartition("/")[2]), rule)
        tree.root.expand()
        if tree.root.children:
            tree.root.children[0].expand()
            self.call_after_refresh(tree.move_cursor, tree.root.children[0].children[0])
        number = sum(len(family["rules"]) for family in answer["families"])
        words = [count(number, "rule"), count(len(answer["families"]), "family", "families")]
        if answer["run"]:
            words.append(f"the last run inferred {count(answer['run']['inferred'], 'triple')}")
        words += answer["problems"]
        self.query_one(".title", Static).update(printable(f"Rules: {', '.join(words)}"))

    async def on_tree_node_highlighted(self, event: Tree.NodeHighlighted[dict[str, Any]]) -> None:
        """Show the rule under the cursor."""
        if event.node.data:
            await self.query_one(Markdown).update(_manual(event.node.data))
            self.query_one("#rule-page").scroll_home(animate=False)

    def action_edit_place(self) -> None:
        """Open the file of the rule."""
        node = self.query_one(Tree).cursor_node
        file = node.data.get("file") if node and node.data else None
        self.app.edit({"file": str(Path(file)), "path": file, "line": 1} if file else None)


def _manual(rule: dict[str, Any]) -> str:
    parts = [f"# {rule['rule']}", f"**{rule['title']}**"]
    if rule["error"]:
        parts.append(f"{rule['error']['code']}: {rule['error']['message']}")
    if rule["derived"] is not None:
        rounds = f" in {count(rule['rounds'], 'round')}" if rule["rounds"] is not None else ""
        parts.append(f"The last run: {count(rule['derived'], 'triple')}{rounds}, {rule['seconds']:.3f} s.")
    elif not rule["in_force"]:
        parts.append("Not in force.")
    parts += [f"## {heading}\n\n{text}" for heading, text in rule["sections"].items()]
    return "\n\n".join(parts)
