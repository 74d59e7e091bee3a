"""Rows and quads as Apache Parquet files, for tables too large for text; needs the extra `parquet` (pyarrow).

A column of rows with only numbers or only booleans has that type. Any other is text: full IRIs, and the text of
literals. Quads have the columns `subject`, `predicate`, `object` and `graph` in the syntax of N-Triples, so they are
complete: equal terms are equal texts, and the four make a line of N-Quads.
"""

from __future__ import annotations

import io
from importlib.util import find_spec
from itertools import islice
from typing import IO, TYPE_CHECKING, Any, Final

from pyoxigraph import DefaultGraph, Quad

from kg.errors import QueryError
from kg.query.writing.values import bare, plain, turtle

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.query.result import Row
    from kg.store.terms import Term

NAME: Final = "parquet"
_MOST: Final = 1 << 63
_BATCH: Final = 1 << 18
"""Number of quads in memory at a time, which form a row group."""
_DICTIONARY_BYTES: Final = 16 << 20


def is_installed() -> bool:
    """Return whether pyarrow is installed."""
    return find_spec("pyarrow") is not None


def written(variables: tuple[str, ...], rows: Iterable[Row]) -> bytes:
    """Return rows as a file; QueryError KG504 without pyarrow."""
    pa, parquet = _library()
    every = list(rows)
    columns = [_column([row[at] for row in every], pa) for at in range(len(variables))]
    output = io.BytesIO()
    parquet.write_table(pa.table(columns, names=list(variables)), output)
    return output.getvalue()


def write_quads(quads: Iterable[Quad], output: IO[bytes]) -> int:
    """Write quads to a file and return their number; the default graph is null. QueryError KG504 without pyarrow."""
    pa, parquet = _library()
    schema = pa.schema([(name, pa.string()) for name in ("subject", "predicate", "object", "graph")])
    number, left = 0, iter(quads)
    # Terms recur often: dictionaries and zstd make a file thirty times smaller than N-Quads.
    with parquet.ParquetWriter(output, schema, compression="zstd", dictionary_pagesize_limit=_DICTIONARY_BYTES) as file:
        while batch := list(islice(left, _BATCH)):
            rows = zip(*map(_spelled, batch), strict=True)
            file.write_table(pa.table([pa.array(column, pa.string()) for column in rows], schema=schema))
            number += len(batch)
    return number


def _spelled(quad: Quad) -> tuple[str, str, str, str | None]:
    graph = None if isinstance(quad.graph_name, DefaultGraph) else str(quad.graph_name)
    return str(quad.subject), str(quad.predicate), turtle(quad.object), graph


def _library() -> tuple[Any, Any]:
    """Return pyarrow and its module for Parquet."""
    if not is_installed():
        raise QueryError("KG504", "Parquet is written by pyarrow, which is not installed", hint=_HINT)
    import pyarrow as pa  # noqa: PLC0415 - takes half a second; an optional extra
    from pyarrow import parquet  # noqa: PLC0415 - as above

    return pa, parquet


_HINT: Final = "`pip install 'kg-ros[parquet]'` installs it; other formats need nothing."


def _column(terms: Sequence[Term | None], pa: Any) -> Any:
    values = [plain(term) for term in terms]
    kinds = {type(value) for value in values if value is not None}
    if kinds == {bool}:
        return pa.array(values, pa.bool_())
    if kinds == {int} and all(-_MOST <= value < _MOST for value in values if isinstance(value, int)):
        return pa.array(values, pa.int64())
    if float in kinds and kinds <= {int, float}:
        return pa.array([None if value is None else float(value) for value in values], pa.float64())
    return pa.array([None if term is None else bare(term) for term in terms], pa.string())
