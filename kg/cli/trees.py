"""Explanations on a terminal: trees whose long lines stay inside their branches, with places as links."""

from __future__ import annotations

from pathlib import Path
from socket import gethostname
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

from rich.text import Text

from kg.cli.links import Links
from kg.cli.output import console, line_width, show
from kg.graph.source_states import sources

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.graph.reading import Queryable
    from kg.rules.explain.text import Line

__all__ = ["print_tree"]

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


def print_tree(lines: Iterable[Line], graph: Queryable) -> None:
    """Write the lines of an explanation; `graph` knows where the sources stand."""
    links = Links.of(sources(graph))
    for line in lines:
        show(*_folded(line, _styled(line, links)))


def _folded(line: Line, text: Text) -> list[Text]:
    """Return the rows of a line: what does not fit goes on below, inside the branches."""
    room = max(_NARROWEST, line_width() - len(line.branches))
    first, *others = [text] if text.cell_len <= room else text.wrap(console(), room - 2)
    below = line.branches[:-3] + _BRANCHES.get(line.branches[-3:], line.branches[-3:])
    rows = [(line.branches, first), *((f"{below}  ", part) for part in others)]
    return [Text.assemble((branches, "dim"), part) for branches, part in rows]


def _styled(line: Line, links: Links) -> Text:
    text = Text(line.text, style=_STYLES[line.kind])
    if line.evidence:
        address = links.find(line.evidence.path, line.evidence.line or 1)
        text.append(f"  {line.evidence}", style=_linked(address))
    elif line.place:
        path = Path(line.place.path).absolute()
        text.append(f"  {line.where}", style=_linked(f"file://{gethostname()}{quote(str(path))}"))
    return text


def _linked(address: str | None) -> str:
    return f"not bold green link {address}" if address else "not bold green"
