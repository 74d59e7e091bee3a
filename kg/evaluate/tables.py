"""A table of figures, with those of the paper, and the forms in which it is kept: Markdown, CSV, objects for JSON.

The paper's figures stand in `corpus/rnkg.toml`, as far as they are known. A section of that file has the name of a
table (completeness, code, correctness, search) and figures from 0 to 1 by the words of its rows: `"topic" = 0.9`.
"""

from __future__ import annotations

import csv
import io
import math
import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from kg.errors import Place, UsageError
from kg.render.svg import document, escaped, label, short
from kg.render.text import printable, width
from kg.resources import table_of


@dataclass(frozen=True, slots=True)
class Share:
    """A number out of a total; the total is None if nothing could be counted, and `interval` is set for a sample."""

    part: int
    whole: int
    interval: tuple[float, float] | None = None

    @property
    def value(self) -> float | None:
        """The share from 0 to 1; None without a total."""
        return self.part / self.whole if self.whole else None


@dataclass(frozen=True, slots=True)
class Score:
    """A figure with its interval; `signed` for a difference, which may be negative."""

    value: float
    interval: tuple[float, float]
    signed: bool = False


_UNKNOWN: Final = "-"

Cell = str | int | float | Share | Score | None
"""A cell of a table: text, a count, a figure from 0 to 1, a share, a score, or unknown."""


@dataclass(frozen=True, slots=True)
class Table:
    """Figures under headings; `name` is that of its files, `notes` are sentences below it."""

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()


COLUMN: Final = "RNKG"


def with_paper(table: Table, keys: tuple[str, ...], figures: Mapping[str, float] | None = None) -> Table:
    """Return the table with a column of the paper's figures, matched by the texts of the columns `keys`.

    The table is unchanged if no figure is known; `figures` replaces those of the file.
    """
    if figures is None:
        figures = table_of("corpus", "rnkg.toml").get(table.name, {})
    places = [table.columns.index(key) for key in keys]
    column = [figures.get(" ".join(str(row[place]) for place in places)) for row in table.rows]
    if all(figure is None for figure in column):
        return table
    rows = tuple((*row, figure) for row, figure in zip(table.rows, column, strict=True))
    return replace(table, columns=(*table.columns, COLUMN), rows=rows)


def spelled(cell: Cell) -> str:
    """Return a cell formatted for people."""
    if cell is None:
        return _UNKNOWN
    if isinstance(cell, Share):
        if cell.value is None:
            return _UNKNOWN
        text = f"{100 * cell.value:.1f} % ({cell.part}/{cell.whole})"
        if cell.interval is None:
            return text
        return f"{text} [{100 * cell.interval[0]:.1f}, {100 * cell.interval[1]:.1f}]"
    if isinstance(cell, Score):
        return _score(cell)
    if isinstance(cell, float):
        return f"{cell:.3f}"
    return f"{cell:,}" if isinstance(cell, int) else cell


def _score(cell: Score) -> str:
    form = "+.3f" if cell.signed else ".3f"
    low, high = cell.interval
    return f"{cell.value:{form}} [{low:{form}}, {high:{form}}]"


def as_markdown(table: Table) -> str:
    """Return the table in Markdown, with its title and notes."""
    lines = [f"## {table.title}", "", _line(table.columns), _line("---" for _ in table.columns)]
    lines += [_line(spelled(cell) for cell in row) for row in table.rows]
    if table.notes:
        lines += ["", *table.notes]
    return "\n".join(lines) + "\n"


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def as_csv(table: Table) -> str:
    """Return the table as CSV (RFC 4180 except for line ends).

    A share fills the columns NAME, NAME part and NAME whole.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    objects = as_objects(table)
    columns = list(dict.fromkeys(key for row in objects for key in row))
    writer.writerow(columns)
    writer.writerows(
        ["" if row.get(column) is None else safe_cell(row[column]) for column in columns] for row in objects
    )
    return out.getvalue()


_FORMULA: Final = ("=", "+", "-", "@")
_LONGEST: Final = 10_000


def safe_cell(value: object) -> object:
    """Return a value as a cell that spreadsheets do not run as a formula; texts from sources may begin like one."""
    if not isinstance(value, str):
        return value
    text = printable(value)[:_LONGEST]
    return f"'{text}" if text.startswith(_FORMULA) else text


def as_objects(table: Table) -> list[dict[str, object]]:
    """Return the rows as plain values for JSON."""
    return [_object(dict(zip(table.columns, row, strict=True))) for row in table.rows]


def _object(row: Mapping[str, Cell]) -> dict[str, object]:
    cells: dict[str, object] = {}
    for name, cell in row.items():
        if not isinstance(cell, Share | Score):
            cells[name] = cell
            continue
        cells[name] = cell.value
        if isinstance(cell, Share):
            cells |= {f"{name} part": cell.part, f"{name} whole": cell.whole}
        if cell.interval is not None:
            cells |= {f"{name} low": cell.interval[0], f"{name} high": cell.interval[1]}
    return cells


_ROW: Final = 22
_GAP: Final = 10
_TOP: Final = 76
_MARGIN: Final = 20
_BAR: Final = 380
_CHARACTER: Final = 7.4
_LONGEST_NAME: Final = 52
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
    left = int(max([0, *(width(short(bar.shown, _LONGEST_NAME)) for bar in bars)]) * 7.9)
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
    yield label("row", start - 12, middle + 4, bar.shown, "end", _LONGEST_NAME)
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


Z95: Final = 1.959963984540054
"""Quantile of the normal distribution for a two-sided 95 % interval."""


def wilson(right: int, number: int) -> tuple[float, float]:
    """Return the interval of the share `right` of `number` (Wilson 1927); (0, 1) for an empty sample.

    It holds for small numbers and for shares near 0 and 1, unlike the normal approximation.
    """
    if number == 0:
        return 0.0, 1.0
    share, spread = right / number, Z95 * Z95 / number
    middle = (share + spread / 2) / (1 + spread)
    half = Z95 * math.sqrt(share * (1 - share) / number + spread / (4 * number)) / (1 + spread)
    low = 0.0 if right == 0 else max(0.0, middle - half)
    return low, 1.0 if right == number else min(1.0, middle + half)


def bootstrap(values: Sequence[float], *, rounds: int = 2000, seed: int = 0) -> tuple[float, float]:
    """Return the 95 % percentile interval of the mean (Efron 1979), deterministic for the same values and seed."""
    if not values:
        return 0.0, 0.0
    chance = random.Random(seed)  # noqa: S311 - no secret
    return bounds(sum(chance.choices(values, k=len(values))) / len(values) for _ in range(rounds))


def bounds(drawn: Iterable[float]) -> tuple[float, float]:
    """Return the bounds of the middle 95 % of one or more values."""
    ordered = sorted(drawn)
    number = len(ordered)
    return ordered[int(0.025 * number)], ordered[min(number - 1, int(0.975 * number))]


def shares_of(sizes: Mapping[str, int], size: int) -> dict[str, int]:
    """Return the sample size of each group: equal, with the remainder of small groups given to others."""
    shares = dict.fromkeys(sizes, 0)
    left = min(size, sum(sizes.values()))
    while left:
        open_ = [name for name, number in sizes.items() if shares[name] < number]
        for name in open_[:left]:
            shares[name] += 1
        left -= len(open_[:left])
    return shares


def weighed(groups: Iterable[tuple[int, int, int]]) -> Score | None:
    """Return the share over all groups with its 95 % interval (Cochran 1977, section 5.6).

    A group has its size, the size of its sample, and the number that is right in it. None if a group has no sample.
    """
    sampled = [group for group in groups if group[0]]
    every = sum(size for size, _, _ in sampled)
    if not every or any(not looked for _, looked, _ in sampled):
        return None
    value = variance = 0.0
    for size, looked, right in sampled:
        weight, part = size / every, right / looked
        value += weight * part
        variance += weight**2 * part * (1 - part) / looked * (1 - looked / size if looked <= size else 0)
    half = Z95 * math.sqrt(variance)
    return Score(value, (max(0.0, value - half), min(1.0, value + half)))
