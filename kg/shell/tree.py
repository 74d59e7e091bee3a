"""The tree of what the store has: packages, nodes, what they publish and need; systems. Read as it is opened."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, ClassVar

from rich.text import Text
from textual.widgets import Tree

from kg.errors import KgError
from kg.render.text import printable
from kg.shell.actions import bindings

if TYPE_CHECKING:
    from textual.binding import BindingType
    from textual.widgets.tree import TreeNode

    from kg.shell.link import Link

__all__ = ["KnowledgeTree"]


class KnowledgeTree(Tree[dict[str, Any]]):
    """An entry is an item of the view `tree`."""

    BINDINGS: ClassVar[list[BindingType]] = bindings("tree")

    def __init__(self, link: Link) -> None:
        super().__init__("store", id="tree")
        self._link = link
        self.show_root = False
        self.auto_expand = False
        self.border_title = "Tree"
        self.begun = asyncio.Event()
        """Set once the first level has been read: what can wait until then does."""

    def on_mount(self) -> None:
        """Read the first level."""
        self.read(self.root)

    def reload(self) -> None:
        """Read all again, and no longer what is being read: its entries are of the tree that is cleared."""
        self.workers.cancel_node(self)
        self.clear()
        self.read(self.root)

    def on_tree_node_expanded(self, event: Tree.NodeExpanded[dict[str, Any]]) -> None:
        """Read what stands below, when it is opened for the first time."""
        if not event.node.children:
            self.read(event.node)

    def read(self, parent: TreeNode[dict[str, Any]]) -> None:
        """Fill an entry with what stands below it, once that is known."""
        self.run_worker(self._read(parent))

    async def _read(self, parent: TreeNode[dict[str, Any]]) -> None:
        arguments = (parent.data or {}).get("open") or {}
        waiting = parent.add_leaf("reading …", {})
        parent.expand()
        try:
            found = await self._link.call("tree", **arguments)
        except KgError as error:
            waiting.set_label(f"{error.code}: {printable(error.message)}")
            return
        finally:
            self.begun.set()
        if not self.is_attached or waiting not in parent.children:
            return
        waiting.remove()
        for item in found["children"]:
            if item["open"]:
                parent.add(_label(item), item)
            else:
                parent.add_leaf(_label(item), item)
        missing = found["total"] - len(found["children"])
        if missing > 0:
            parent.add_leaf(f"… and {missing:,} more: F2 finds them", {})

    @property
    def entry(self) -> dict[str, Any]:
        """The entry under the cursor; empty without one."""
        return (self.cursor_node.data if self.cursor_node else None) or {}


def _label(item: dict[str, Any]) -> Text:
    parts: list[Any] = [printable(item["label"])]
    if item["open"]:
        parts.append((f" {item['count']:,}", "dim"))
    if item["detail"]:
        parts.append((f"  {printable(item['detail'])}", "dim"))
    return Text.assemble(*parts, no_wrap=True)
