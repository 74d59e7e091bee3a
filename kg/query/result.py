"""What a query answers: rows, yes or no, or a graph."""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass
from html import escape
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.query.writing.values import display, plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from pandas import DataFrame  # type: ignore[import-not-found, import-untyped, unused-ignore]  # it is optional
    from pyoxigraph import Triple

    from kg.store.terms import Term

Row: TypeAlias = "tuple[Term | None, ...]"

_SHOWN: Final = 100
"""How many rows a notebook shows."""


@dataclass(frozen=True, slots=True)
class Solutions:
    """The answer of SELECT: a row has a term, or None where it is unbound, for each of the `variables`.

    Iteration yields plain values instead of terms, as named tuples: `row.name`. Notebooks show a table.

    `limit` is set when more rows were there than it allowed. `seconds` is the time of the query, `snapshot` the
    identity of the data that it was asked of; both for the other answers too.
    """

    variables: tuple[str, ...]
    rows: tuple[Row, ...]
    seconds: float
    snapshot: str
    limit: int | None = None

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Any]:
        """Yield each row as a named tuple of strings, numbers and booleans; an IRI is its text, None is unbound.

        A variable whose name is a word of Python, or begins with `_`, is called by its position: `_0`.
        """
        make = namedtuple("Row", self.variables, rename=True)  # type: ignore[misc]  # noqa: PYI024 - names of a query
        return (make(*map(plain, row)) for row in self.rows)

    def dicts(self) -> list[dict[str, str | int | float | bool | None]]:
        """Return the rows as dictionaries from variables to plain values."""
        return [dict(zip(self.variables, map(plain, row), strict=True)) for row in self.rows]

    def dataframe(self) -> DataFrame:
        """Return the rows as a pandas DataFrame with a column for each variable.

        Raises ModuleNotFoundError where pandas is not installed.
        """
        from pandas import DataFrame as Frame  # noqa: PLC0415 - optional

        return Frame(self.dicts(), columns=list(self.variables))

    def _repr_html_(self) -> str:
        return _table(self.variables, (map(display, row) for row in self.rows), len(self))


@dataclass(frozen=True, slots=True)
class Boolean:
    """The answer of ASK; true or false as a condition."""

    value: bool
    seconds: float
    snapshot: str
    limit: int | None = None

    def __bool__(self) -> bool:
        return self.value


@dataclass(frozen=True, slots=True)
class Graph:
    """The answer of CONSTRUCT and DESCRIBE, each triple once."""

    triples: tuple[Triple, ...]
    seconds: float
    snapshot: str
    limit: int | None = None

    def __len__(self) -> int:
        return len(self.triples)

    def __iter__(self) -> Iterator[Triple]:
        """Yield the triples, as terms of pyoxigraph."""
        return iter(self.triples)

    def _repr_html_(self) -> str:
        rows = ((display(one.subject), display(one.predicate), display(one.object)) for one in self.triples)
        return _table(("subject", "predicate", "object"), rows, len(self))


def _table(head: Sequence[str], rows: Iterable[Iterable[str]], number: int) -> str:
    """Return the first rows as a table in HTML, and how many more there are."""

    def line(tag: str, cells: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(line("td", row) for row in islice(rows, _SHOWN))
    more = f"<p>{number - _SHOWN} more rows</p>" if number > _SHOWN else ""
    return f"<table><thead>{line('th', head)}</thead><tbody>{body}</tbody></table>{more}"


Result: TypeAlias = Solutions | Boolean | Graph
