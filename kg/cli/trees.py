"""Proofs on a terminal: trees with folded lines, and places as links."""

from __future__ import annotations

from pathlib import Path
from socket import gethostname
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

from rich.text import Text

from kg.cli.links import Links
from kg.cli.output import folded, show
from kg.facts import Location
from kg.render.text import count, printable
from kg.views.wording import quoted

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.graph.iris import Iris
    from kg.rules.explain.text import Line
    from kg.views.evidence import Places

_STYLES: Final = {
    "rule": "cyan",
    "bindings": "dim",
    "condition": "",
    "failure": "red",
    "hint": "yellow",
    "fact": "bold",
}
_LONG: Final = 30
"""Rows of a tree from which on its lines of code are listed below it."""
_BRANCHES: Final = {"├─ ": "│  ", "└─ ": "   "}


def print_tree(lines: Iterable[Line], where: Places, iris: Iris | None = None) -> None:
    """Write the lines of a proof; `where` finds sources and their lines.

    With `iris`, those of the store, each line of code is shown below the first fact read from it; below a tree that is
    long, all of them follow once more.
    """
    links = Links(where)
    read: set[tuple[str, str, int | None]] = set()
    cited: list[tuple[Text, str]] = []
    rules: set[str] = set()
    shown = 0
    for line in lines:
        rows = _folded(line, links)
        show(*rows)
        shown += len(rows)
        if line.kind == "rule":
            rules.add(line.text)
        place = (line.evidence.repository or "", line.evidence.path, line.evidence.line) if line.evidence else None
        if iris is None or place is None or place in read:
            continue
        read.add(place)
        if code := _code(line, where, iris):
            show(_dim(f"{_below(line)}  {code}"))
            cited.append((_place(line, links) or Text(), code))
    if shown > _LONG and cited:
        show(Text(f"\n{count(len(rules), 'rule')}, from {count(len(cited), 'line')} of code:"))
        for at, code in cited:
            show(Text("  ").append_text(at), _dim(f"    {code}"))


def _code(line: Line, where: Places, iris: Iris) -> str | None:
    """Return the line of code behind a fact."""
    thing = iris.parse((line.evidence.thing or "").partition("#")[0]) if line.evidence else None
    if line.evidence is None or line.evidence.line is None or thing is None:
        return None
    place = Location(line.evidence.path, line.evidence.line, line.evidence.repository)
    code = quoted(where.code(thing.parts[0], place))
    return printable(code) if code else None


def _dim(line: str) -> Text:
    """Return a row that is cut where the terminal ends."""
    return Text(line, style="dim", no_wrap=True, overflow="ellipsis")


def _folded(line: Line, links: Links) -> list[Text]:
    """Return the rows of a line, folded inside its branch; places are never broken."""
    words, place = Text(line.text, style=_STYLES[line.kind]), _place(line, links)
    return folded(words, place, Text(line.branches, "dim"), Text(f"{_below(line)}  ", "dim"))


def _place(line: Line, links: Links) -> Text | None:
    """Return where the evidence of a line is, or else its rule, with a link."""
    place = line.evidence or line.place
    if place is None:
        return None
    path = Path(place.path)
    if line.evidence and not path.is_absolute():
        address = links.find(place.path, place.line or 1)
    else:
        address = f"file://{gethostname()}{quote(str(path.absolute()))}"
    return Text(line.where, style=f"green link {address}" if address else "green")


def _below(line: Line) -> str:
    """Return the branches of the rows below a line."""
    return line.branches[:-3] + _BRANCHES.get(line.branches[-3:], line.branches[-3:])
