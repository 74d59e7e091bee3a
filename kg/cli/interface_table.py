"""A table of interfaces that fits the terminal: paths are shortened first, then remarks move below their rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.cli.output import shortened
from kg.lazily import lazily
from kg.render.text import printable, width

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.cli.links import Links
    from kg.facts import Location

with lazily():
    from rich.table import Table
    from rich.text import Text

_GAP: Final = 3
_LEAST_REMARK: Final = 16


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the table; `dim` for endpoints that a framework creates."""

    name: str
    type: str
    remark: str
    location: Location
    dim: bool
    via: tuple[Location, ...] = ()
    """The calls from the location to the framework, shown below the location."""


@dataclass(frozen=True, slots=True)
class _Layout:
    """How places are written, and whether remarks are below the types; columns with a width are not folded."""

    places: Mapping[Location, str]
    type_width: int | None = None
    place_width: int | None = None
    stacked: bool = False


def interface_table(groups: Sequence[tuple[str, Sequence[Row]]], repository: str, links: Links, columns: int) -> Table:
    """Return a rich table of groups with their titles, for a terminal of so many columns."""
    from rich.box import SIMPLE_HEAD  # noqa: PLC0415 - start-up time

    rows = [row for _, listed in groups for row in listed]
    layout = _layout(rows, columns)
    table = Table(box=SIMPLE_HEAD, show_header=False, pad_edge=False, show_edge=False, padding=(0, 2, 0, 0))
    table.add_column(overflow="fold")
    table.add_column(overflow="fold", min_width=layout.type_width)
    if not layout.stacked:
        table.add_column(overflow="fold")
    table.add_column(overflow="fold", min_width=layout.place_width)
    for number, (title, listed) in enumerate(groups):
        if number:
            table.add_row()
        table.add_row(Text(title, style="bold cyan"))
        for row in listed:
            style = "dim" if row.dim else ""
            name = Text(f"  {printable(row.name)}", style=style or "bold")
            places = [place_text(one, repository, links, layout.places[one]) for one in (row.location, *row.via)]
            middle = [printable(row.type), printable(row.remark)]
            if layout.stacked:
                middle = ["\n".join(filter(None, middle))]
            table.add_row(name, *(Text(text, style=style) for text in middle), Text("\nvia ", style="dim").join(places))
    return table


def place_text(location: Location, repository: str, links: Links, shown: str | None = None) -> Text:
    """Return a place as rich text with a link to the file."""
    address = links.to(repository, location)
    text = _where(location) if shown is None else shown
    return Text(printable(text), style=f"dim link {address}" if address else "dim")


def _where(location: Location) -> str:
    return f"{location.repository}:{location}" if location.repository else str(location)


def _layout(rows: Sequence[Row], columns: int) -> _Layout:
    """Return the first layout that fits; the last one is folded if necessary."""
    locations = list(dict.fromkeys(one for row in rows for one in (row.location, *row.via)))
    forms = [dict(zip(locations, form, strict=True)) for form in shortened([_where(one) for one in locations])]
    whole, without_shared, names = forms
    remark = max(width(row.remark) for row in rows)
    types = max(width(row.type) for row in rows)
    sides = max(width(row.name) for row in rows) + 2 + types + _GAP
    calls = len("via ") if any(row.via for row in rows) else 0
    choices = ((whole, remark), (without_shared, remark), (names, min(remark, _LEAST_REMARK)))
    for places, room in choices:
        last = max(map(width, places.values())) + calls
        if sides + room + 2 * _GAP + last <= columns:
            return _Layout(places, types, last)
    last = max(map(width, names.values())) + calls
    return _Layout(names, types, last, stacked=True) if sides + _GAP + last <= columns else _Layout(names, stacked=True)
