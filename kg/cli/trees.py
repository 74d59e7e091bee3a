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
from kg.render.text import printable
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
_BRANCHES: Final = {"├─ ": "│  ", "└─ ": "   "}


def print_tree(lines: Iterable[Line], where: Places, iris: Iris | None = None) -> None:
    """Write the lines of a proof; `where` finds sources and their lines.

    With `iris`, those of the store, each line of code is shown below the first fact read from it.
    """
    links = Links(where)
    read: set[tuple[str, str, int | None]] = set()
    for line in lines:
        show(*_folded(line, links))
        place = (line.evidence.repository or "", line.evidence.path, line.evidence.line) if line.evidence else None
        if iris is None or place is None or place in read:
            continue
        read.add(place)
        if code := _code(line, where, iris):
            show(code)


def _code(line: Line, where: Places, iris: Iris) -> Text | None:
    """Return the line of code behind a fact."""
    thing = iris.parse((line.evidence.thing or "").partition("#")[0]) if line.evidence else None
    if line.evidence is None or line.evidence.line is None or thing is None:
        return None
    place = Location(line.evidence.path, line.evidence.line, line.evidence.repository)
    code = quoted(where.code(thing.parts[0], place))
    if not code:
        return None
    text = Text(f"{_below(line)}  {printable(code)}", style="dim")
    text.no_wrap, text.overflow = True, "ellipsis"
    return text


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
