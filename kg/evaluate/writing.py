"""A table as files: Markdown, CSV, and a figure as SVG with a bar for each share and score.

Series are labelled at each bar, not only by colour. The same table always gives the same bytes. Colours follow
`prefers-color-scheme`; `title` and `desc` describe the figure in words.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import Place, UsageError
from kg.evaluate.tables import Cell, Score, Share, Table, as_csv, as_markdown, spelled
from kg.render.svg import document, escaped, label, short
from kg.render.text import width

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


_ROW: Final = 22
_GAP: Final = 10
_TOP: Final = 76
_MARGIN: Final = 20
_BAR: Final = 380
_CHARACTER: Final = 7.4
_LONGEST: Final = 52
_SERIES: Final = 4


@dataclass(frozen=True, slots=True)
class _Bar:
    """One bar: its row and series in `words`, its value from 0 to 1, its interval, and how the table spells it.

    `shown` are the words without the row, unless the bar is the `first` of that.
    """

    words: str
    shown: str
    first: bool
    series: int
    value: float
    interval: tuple[float, float] | None
    text: str


def draw(table: Table) -> str:
    """Return the SVG of a table's shares, scores and figures from 0 to 1; differences are omitted."""
    bars = list(_bars(table))
    left = int(max([0, *(width(short(bar.shown, _LONGEST)) for bar in bars)]) * 7.9)
    right = int(max([0, *(width(bar.text) for bar in bars)]) * _CHARACTER)
    start = _MARGIN + left + 12
    across = max(start + _BAR + 12 + right + _MARGIN, int(width(short(table.title, 90)) * 10.3) + 2 * _MARGIN)
    body, bottom = _drawn(bars, start)
    heading = label("title", _MARGIN, _MARGIN + 16, table.title, longest=90)
    drawn = [heading, *_grid(start, bottom), *body]
    description = "; ".join(f"{bar.words}: {bar.text}" for bar in bars) or "Nothing could be counted."
    return document("figure", (across, bottom + _MARGIN), table.title, description, drawn)


def _bars(table: Table) -> Iterator[_Bar]:
    series = [name for at, name in enumerate(table.columns) if any(_value(row[at]) is not None for row in table.rows)]
    before = None
    for row in table.rows:
        texts = ", ".join(cell for cell in row if isinstance(cell, str))
        for name, cell in zip(table.columns, row, strict=True):
            value = _value(cell)
            if value is not None:
                interval = cell.interval if isinstance(cell, Share | Score) else None
                named = name if len(series) > 1 else ""
                words, first = f"{texts} {named}".strip(), texts != before
                shown = words if first else named
                yield _Bar(words, shown, first, series.index(name) % _SERIES, value, interval, spelled(cell))
                before = texts


def _value(cell: Cell) -> float | None:
    if isinstance(cell, Share):
        return cell.value
    if isinstance(cell, Score):
        return None if cell.signed else cell.value
    return cell if isinstance(cell, float) and 0 <= cell <= 1 else None


def _drawn(bars: list[_Bar], start: int) -> tuple[list[str], int]:
    """Return the bars from the top down, and the bottom edge."""
    parts: list[str] = []
    y = _TOP
    for bar in bars:
        y += _GAP if bar.first and bar is not bars[0] else 0
        parts += _bar(bar, start, y)
        y += _ROW
    return parts, y


def _bar(bar: _Bar, start: int, y: int) -> Iterator[str]:
    middle = y + _ROW / 2
    yield f"<g><title>{escaped(f'{bar.words}: {bar.text}')}</title>"
    yield label("row", start - 12, middle + 4, bar.shown, "end", _LONGEST)
    yield f'<rect class="s{bar.series}" x="{start}" y="{y + 3}" width="{_BAR * bar.value:.1f}" height="{_ROW - 6}"/>'
    if bar.interval is not None:
        low, high = (start + _BAR * max(0.0, min(1.0, end)) for end in bar.interval)
        yield f'<path class="interval" d="M{low:.1f} {middle - 4:g}v8M{low:.1f} {middle:g}H{high:.1f}m0 -4v8"/>'
    yield label("value", start + _BAR + 12, middle + 4, bar.text, longest=60)
    yield "</g>"


def _grid(start: int, bottom: int) -> Iterator[str]:
    for step in range(6):
        x = start + _BAR * step / 5
        yield f'<path class="grid" d="M{x:g} {_TOP - 8}V{bottom}"/>'
        yield label("tick", x, _TOP - 14, f"{step / 5:g}", "middle")


def write(table: Table, folder: Path) -> tuple[Path, ...]:
    """Write `NAME.md`, `NAME.csv` and `NAME.svg` into a folder, created if missing; return their paths.

    Raises UsageError: KG003 a file cannot be written.
    """
    texts = {
        folder / f"{table.name}.md": as_markdown(table),
        folder / f"{table.name}.csv": as_csv(table),
        folder / f"{table.name}.svg": draw(table),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, text in texts.items():
            path.write_text(text, "utf-8")
    except OSError as error:
        place = Place(str(error.filename or folder))
        raise UsageError("KG003", f"the table cannot be written: {error.strerror}", place=place) from None
    return tuple(texts)
