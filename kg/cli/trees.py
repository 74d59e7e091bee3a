"""Proofs on a terminal: trees with folded lines, and places as links."""

from __future__ import annotations

from pathlib import Path
from socket import gethostname
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

from rich.text import Text

from kg.cli.links import Links
from kg.cli.output import console, line_width, show
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
_NARROWEST: Final = 24


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
    below = line.branches[:-3] + _BRANCHES.get(line.branches[-3:], line.branches[-3:])
    text = Text(f"{below}  {printable(code)}", style="dim")
    text.no_wrap, text.overflow = True, "ellipsis"
    return text


def _folded(line: Line, links: Links) -> list[Text]:
    """Return the rows of a line, folded inside its branch; places are never broken."""
    room = max(_NARROWEST, line_width() - len(line.branches))
    text, place = Text(line.text, style=_STYLES[line.kind]), _place(line, links)
    parts = [text] if text.cell_len <= room else list(text.wrap(console(), room - 2))
    if place and parts[-1].cell_len + place.cell_len + 2 > room - (2 if len(parts) > 1 else 0):
        parts.append(place)
    elif place:
        parts[-1] = Text.assemble(parts[-1], "  ", place)
    below = line.branches[:-3] + _BRANCHES.get(line.branches[-3:], line.branches[-3:])
    starts = [line.branches, *[f"{below}  "] * (len(parts) - 1)]
    rows = [Text.assemble((start, "dim"), part) for start, part in zip(starts, parts, strict=True)]
    for row in rows:
        row.no_wrap, row.overflow = True, "ignore"
    return rows


def _place(line: Line, links: Links) -> Text | None:
    if line.evidence:
        path = Path(line.evidence.path)
        address = _file(path) if path.is_absolute() else links.find(line.evidence.path, line.evidence.line or 1)
        return Text(line.where, style=_linked(address))
    return Text(line.where, style=_linked(_file(Path(line.place.path)))) if line.place else None


def _file(path: Path) -> str:
    return f"file://{gethostname()}{quote(str(path.absolute()))}"


def _linked(address: str | None) -> str:
    return f"green link {address}" if address else "green"
