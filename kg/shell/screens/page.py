"""Pages of rows, things, nodes and proofs: trees of lines with links, whose content comes from views."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

from pyoxigraph import BlankNode, NamedNode
from rich.text import Text
from textual.widgets import Footer, Static, Tree

from kg.query.writing.values import display
from kg.render.text import count, printable
from kg.shell.delivery import deliver
from kg.shell.screens.base import Acting, UpperScreen
from kg.views.wording import quoted

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.widgets.tree import TreeNode

    from kg.errors import KgError
    from kg.store.terms import Term


Fact: TypeAlias = tuple[str, str, str]
"""Subject, predicate and object for the view `why`."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a page: `iri` is the thing it names, `place` its source, `fact` its triple.

    `mark` follows the text, for inferred facts; `note` is less important. `children` are below it.
    """

    text: str
    iri: str = ""
    place: Mapping[str, Any] | None = None
    fact: Fact | None = None
    mark: str = ""
    note: str = ""
    children: tuple[Line, ...] = ()
    open: bool = True


@dataclass(frozen=True, slots=True)
class Page:
    """The content of a page: `view` and `arguments` are requested when it is shown, `lines` are available at once.

    `query` is SPARQL for the same facts, for a buffer.
    """

    title: str
    view: str = ""
    arguments: dict[str, Any] = field(default_factory=dict)
    lines: tuple[Line, ...] = ()
    query: str = ""


def place_words(place: Mapping[str, Any] | None) -> str:
    """Return a short form of a place, `src/talker.cpp:12`."""
    if not place:
        return ""
    return f"{place['path']}:{place['line']}" if place.get("line") else str(place["path"])


def _section(title: str, lines: Iterable[Line], *, opened: bool = True) -> list[Line]:
    children = tuple(lines)
    return [Line(f"{title} ({len(children)})", children=children, open=opened)] if children else []


def _fact(fact: Mapping[str, str] | None) -> Fact | None:
    if fact is None:
        return None
    return (f"<{fact['subject']}>", f"<{fact['predicate']}>", f"<{fact['object']}>")


def _inferred(mark: object) -> str:
    return "inferred" if mark else ""


def lines_of_node(node: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the page of a node from the view `node`."""
    about = [
        Line(f"{node['kind']} in {node['language']}, ROS {node['ros']}", place=node["evidence"]),
        Line(f"package {node['package']['name']}", iri=node["package"]["iri"]),
        Line(f"repository {node['repository']['name']}", iri=node["repository"]["iri"], note=node["commit"] or ""),
        *([Line(f"start: {node['start']}")] if node["start"] else []),
        *([] if node["functions"] else [Line("function: unknown")]),
    ]
    classes = [
        line
        for kind in ("functions", "capabilities", "hardware", "devices")
        for line in _section(
            kind.capitalize(),
            (
                Line(
                    one["label"],
                    iri=one["iri"],
                    fact=_fact(one["fact"]),
                    mark=_inferred(one["inferred"]),
                    note=one["grade"],
                )
                for one in node[kind]
            ),
        )
    ]
    return (
        *about,
        *_section("Interfaces", map(_interface, node["interfaces"])),
        *_section("Descriptions", (Line(one["text"], place=one["evidence"]) for one in node["descriptions"][:5])),
        *classes,
        *_section("Parameters", map(_parameter, node["parameters"]), opened=False),
        *_section("Connected to", map(_neighbours, node["neighbours"])),
        *_section(
            "Used in",
            (
                Line(f"{one['name']} in {one['system']}", iri=one["instance"], place=one["evidence"])
                for one in node["used_in"]["instances"]
            ),
            opened=False,
        ),
    )


def _interface(one: Mapping[str, Any]) -> Line:
    name = one.get("resolved") or one.get("name") or one.get("written") or "(unknown)"
    text = f"{one['title']} {name}" + (f"  [{one['type']}]" if one.get("type") else "")
    mark = _inferred(one["fact"])
    return Line(text, one["channel_iri"] or one["iri"] or "", one["evidence"], _fact(one["fact"]), mark, one["how"])


def _parameter(one: Mapping[str, Any]) -> Line:
    words = str(one.get("name") or "(unknown name)")
    if one.get("default") is not None:
        words += f" = {one['default']}"
    return Line(words, one["iri"] or "", one["evidence"], note=one["does"] if isinstance(one["does"], str) else "")


def _neighbours(one: Mapping[str, Any]) -> Line:
    arrow = "→" if one["outward"] else "←"
    below = tuple(Line(f"{node['package']}/{node['name']}", iri=node["iri"]) for node in one["nodes"])
    more = f"{one['count']} nodes, {len(below)} shown" if one["count"] > len(below) else ""
    return Line(f"{arrow} {one['channel']}", iri=one["channel_iri"], note=more, children=below)


def title_of(view: str, data: Mapping[str, Any]) -> str:
    """Return the title of a loaded page; empty if it keeps its name."""
    if view == "node":
        return f"{data['name']}, node of {data['package']['name']}"
    return str(data["label"]) if view == "resource" else ""


def lines_of_resource(resource: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the page of a thing from the view `resource`."""
    comment = [Line(resource["comment"])] if resource["comment"] else []
    uses = [Line(f"the property of {count(resource['uses'], 'fact')}")] if resource["uses"] else []
    groups = [_group(one, outward=side == "out") for side in ("out", "in") for one in resource[side]]
    return (Line(resource["short"], place=resource["evidence"]), *comment, *uses, *groups)


def _group(one: Mapping[str, Any], *, outward: bool) -> Line:
    """Return the facts of one property; those with the thing as the object are read backwards."""
    label, shown = one["predicate"]["label"], tuple(map(_resource_fact, one["facts"]))
    number = f"{one['count']:,}" + (f", {len(shown)} shown" if one["count"] > len(shown) else "")
    text = f"{label} ({number})" if outward else f"is {label} of ({number})"
    return Line(text, iri="", children=shown)


def _resource_fact(one: Mapping[str, Any]) -> Line:
    value, fact = one["value"], one["fact"]
    text = value["label"] if "iri" in value else value["text"]
    parts = (fact["subject"], fact["predicate"], fact["object"])
    return Line(text, value.get("iri", ""), one["evidence"], parts, _inferred(one["inferred"]), value.get("kind", ""))


def lines_of_system(
    system: Mapping[str, Any], started: Iterable[Mapping[str, Any]], findings: Mapping[str, Any]
) -> tuple[Line, ...]:
    """Return the findings and nodes of a launch configuration, from the views `systems`, `tree`, `lint`."""
    nodes = (Line(one["label"], iri=one.get("node") or one["iri"] or "", note=one["detail"]) for one in started)
    finding_lines = [_finding(one) for one in findings["findings"]]
    allowed = [Line(f"{findings['allowed']} more are allowed")] if findings["allowed"] else []
    return (
        Line(f"{system['name']}, ROS {system['ros']}", iri=system["iri"], note=system["repository"]),
        *_section("Findings", finding_lines),
        *([] if finding_lines else [Line("kg lint found no problems.")]),
        *allowed,
        *_section("Starts", nodes),
    )


def _finding(one: Mapping[str, Any]) -> Line:
    places = tuple(
        Line(place["words"] or place["line_text"] or place_words(place), place=place, note=place["chain"] or "")
        for place in one["evidence"]
    )
    hints = tuple(Line(text) for text in (one["hint"], one["way_out"]) if text)
    text = f"{one['severity']} {one['code']}: {one['message']}"
    return Line(text, place=one["place"], fact=_fact(one["fact"]), children=(*places, *hints), open=False)


def lines_of_proof(answer: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the proofs of the view `why`, each down to the lines of code."""
    more = "more than " if answer["more_ways"] else ""
    ways = [Line(f"one of {more}{answer['ways']} ways")] if answer["ways"] > 1 else []
    return (*(_proof(one) for one in answer["proofs"]), *ways)


def lines_of_row(answer: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the proof of a row."""
    conditions = (Line(f"where {text}") for text in answer["conditions"])
    remarks = [Line(answer["remark"])] if answer["remark"] else []
    return tuple(_section("Rests on", [*map(_proof, answer["proofs"]), *conditions, *remarks]))


def _proof(one: Mapping[str, Any]) -> Line:
    fact = (one["subject"]["term"], one["predicate"]["term"], one["object"]["term"])
    if not one["inferred"]:
        return Line(one["text"], place=one["evidence"], fact=fact, note=quoted(one))
    rule = one["rule"]
    note = "proven above" if one["again"] else ""
    because = Line(f"by rule {rule['name']}: {rule['title']}", place=rule["evidence"])
    conditions = (
        Line(
            f"where {condition['text']}",
            children=tuple(Line(fact["text"], place=fact["evidence"]) for fact in condition["facts"]),
            open=False,
        )
        for condition in one["conditions"]
    )
    below = (because, *map(_proof, one["premises"]), *conditions)
    return Line(one["text"], fact=fact, mark="inferred", note=note, children=below)


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

    def __init__(self, page: Page) -> None:
        super().__init__()
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
            request = partial(self.app.link.call, page.view, **page.arguments)
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
