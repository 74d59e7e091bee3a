"""The tree of the store: packages, nodes and their interfaces; systems. Loaded as it is expanded."""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from rich.text import Text
from textual.widgets import Tree

from kg.render.text import printable
from kg.shell.actions import bindings
from kg.shell.delivery import deliver

if TYPE_CHECKING:
    from textual.binding import BindingType
    from textual.widgets.tree import TreeNode

    from kg.errors import KgError
    from kg.shell.link import Link


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
        """Set once the first level has been loaded: other preparation waits for it."""

    def on_mount(self) -> None:
        """Load the first level."""
        self.read(self.root)

    def reload(self) -> None:
        """Reload everything, and cancel pending loads, whose entries belong to the cleared tree."""
        self.workers.cancel_node(self)
        self.clear()
        self.read(self.root)

    def on_tree_node_expanded(self, event: Tree.NodeExpanded[dict[str, Any]]) -> None:
        """Load the children when an entry is expanded for the first time."""
        if not event.node.children:
            self.read(event.node)

    def read(self, parent: TreeNode[dict[str, Any]]) -> None:
        """Load the children of an entry."""
        waiting = parent.add_leaf("reading …", {})
        parent.expand()
        arguments = (parent.data or {}).get("open") or {}

        def fail(error: KgError) -> None:
            waiting.set_label(f"{error.code}: {printable(error.message)}")

        deliver(self, partial(self._children, arguments), partial(self._fill, waiting), fail)

    async def _children(self, arguments: dict[str, Any]) -> Any:
        try:
            return await self._link.call("tree", **arguments)
        finally:
            self.begun.set()

    def _fill(self, waiting: TreeNode[dict[str, Any]], answer: dict[str, Any]) -> None:
        """Replace the placeholder with the loaded entries."""
        parent = waiting.parent
        assert parent is not None  # noqa: S101 - it was added to one
        waiting.remove()
        for item in answer["children"]:
            if item["open"]:
                parent.add(_label(item), item)
            else:
                parent.add_leaf(_label(item), item)
        missing = answer["total"] - len(answer["children"])
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
