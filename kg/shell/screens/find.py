"""The screens of the search, of the rules by family, and of launch configurations with their findings."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from textual import on
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.widgets import Footer, Input, Markdown, Static, Tree

from kg.render.text import count, printable
from kg.shell.delivery import deliver
from kg.shell.screens.base import UpperScreen
from kg.shell.screens.page import Line, LineTree, PageScreen, lines_of_system, place_words, proof_page, thing

if TYPE_CHECKING:
    from collections.abc import Sequence

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
        return f"Nothing was found. {answer['advice']}"
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
