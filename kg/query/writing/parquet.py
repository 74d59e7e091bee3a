"""Rows as an Apache Parquet file, for tables too large for text; needs the extra `parquet` (pyarrow).

A column with only numbers or only booleans has that type. Any other is text: full IRIs, and the text of literals.
"""

from __future__ import annotations

import io
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Final

from kg.errors import QueryError
from kg.query.writing.values import bare, plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.query.result import Row
    from kg.store.terms import Term

NAME: Final = "parquet"
_MOST: Final = 1 << 63


def is_installed() -> bool:
    """Return whether pyarrow is installed."""
    return find_spec("pyarrow") is not None


def written(variables: tuple[str, ...], rows: Iterable[Row]) -> bytes:
    """Return rows as a file; QueryError KG504 without pyarrow."""
    if not is_installed():
        raise QueryError("KG504", "Parquet is written by pyarrow, which is not installed", hint=_HINT)
    import pyarrow as pa  # noqa: PLC0415 - takes half a second; an optional extra
    from pyarrow import parquet  # noqa: PLC0415 - as above

    every = list(rows)
    columns = [_column([row[at] for row in every], pa) for at in range(len(variables))]
    output = io.BytesIO()
    parquet.write_table(pa.table(columns, names=list(variables)), output)
    return output.getvalue()


_HINT: Final = "`pip install 'kg-ros[parquet]'` installs it; CSV and JSON Lines need nothing."


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
