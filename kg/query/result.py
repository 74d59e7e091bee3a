"""Results of queries: rows, booleans and graphs."""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass
from html import escape
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.query.writing.values import display, plain
from kg.render.text import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from pandas import DataFrame  # type: ignore[import-not-found, import-untyped, unused-ignore]  # it is optional
    from pyoxigraph import Triple

    from kg.store.terms import Term

Row: TypeAlias = "tuple[Term | None, ...]"

_SHOWN: Final = 100
"""Number of rows shown in a notebook."""
_PRINTED: Final = 20
"""Number of rows shown at the prompt of Python."""


@dataclass(frozen=True, slots=True)
class Solutions:
    """Result of SELECT: a row contains a term, or None if unbound, for each of the `variables`.

    Iteration yields named tuples of plain values instead of terms: `row.name`. Notebooks show a table.

    `limit` is set if it cut the rows. `seconds` is the time of the query, `snapshot` the identity of its data; the
    other results have them too.
    """

    variables: tuple[str, ...]
    rows: tuple[Row, ...]
    seconds: float
    snapshot: str
    limit: int | None = None

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Any]:
        """Yield each row as a named tuple of strings, numbers and booleans; IRIs are strings, unbound variables None.

        A variable whose name is a keyword of Python or begins with `_` is named by its position: `_0`.
        """
        make = namedtuple("Row", self.variables, rename=True)  # type: ignore[misc]  # noqa: PYI024 - names of a query
        return (make(*map(plain, row)) for row in self.rows)

    def dicts(self) -> list[dict[str, str | int | float | bool | None]]:
        """Return the rows as dictionaries from variables to plain values."""
        return [dict(zip(self.variables, map(plain, row), strict=True)) for row in self.rows]

    def dataframe(self) -> DataFrame:
        """Return the rows as a pandas DataFrame with a column for each variable.

        Raises ModuleNotFoundError if pandas is not installed.
        """
        from pandas import DataFrame as Frame  # noqa: PLC0415 - optional

        return Frame(self.dicts(), columns=list(self.variables))

    def __repr__(self) -> str:
        return _text(self.variables, (map(display, row) for row in self.rows), len(self))

    def _repr_html_(self) -> str:
        return _table(self.variables, (map(display, row) for row in self.rows), len(self))


@dataclass(frozen=True, slots=True)
class Boolean:
    """Result of ASK; usable as a condition."""

    value: bool
    seconds: float
    snapshot: str
    limit: int | None = None

    def __bool__(self) -> bool:
        return self.value


@dataclass(frozen=True, slots=True)
class Graph:
    """Result of CONSTRUCT and DESCRIBE, without duplicates."""

    triples: tuple[Triple, ...]
    seconds: float
    snapshot: str
    limit: int | None = None

    def __len__(self) -> int:
        return len(self.triples)

    def __iter__(self) -> Iterator[Triple]:
        """Yield the triples as pyoxigraph terms."""
        return iter(self.triples)

    def __repr__(self) -> str:
        return _text(_PARTS, self._shown(), len(self))

    def _repr_html_(self) -> str:
        return _table(_PARTS, self._shown(), len(self))

    def _shown(self) -> Iterator[tuple[str, ...]]:
        return ((display(one.subject), display(one.predicate), display(one.object)) for one in self.triples)


_PARTS: Final = ("subject", "predicate", "object")


def _text(head: Sequence[str], rows: Iterable[Iterable[str]], number: int) -> str:
    """Return the first rows as columns, with the number of all rows."""
    shown = [tuple(head), *(tuple(map(printable, row)) for row in islice(rows, _PRINTED))]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in shown]
    more = f", the first {_PRINTED} shown" if number > _PRINTED else ""
    return "\n".join([*lines, f"({number} {'row' if number == 1 else 'rows'}{more})"])


def _table(head: Sequence[str], rows: Iterable[Iterable[str]], number: int) -> str:
    """Return the first rows as an HTML table, with the number of further rows."""

    def line(tag: str, cells: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(line("td", row) for row in islice(rows, _SHOWN))
    more = f"<p>{number - _SHOWN} more rows</p>" if number > _SHOWN else ""
    return f"<table><thead>{line('th', head)}</thead><tbody>{body}</tbody></table>{more}"


Result: TypeAlias = Solutions | Boolean | Graph
