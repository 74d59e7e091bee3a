"""Running stored queries by name, with parameters as text and suggestions when nothing was found."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import Literal, NamedNode

from kg.query.core import run
from kg.query.result import Solutions
from kg.query.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.query.result import Result
    from kg.query.stored import StoredQuery
    from kg.store.interface import Snapshot

__all__ = ["ask", "suggestion"]


def ask(
    snapshot: Snapshot,
    query: StoredQuery,
    values: Mapping[str, str],
    *,
    timeout: float | None = None,
    limit: int | None = None,
) -> Result:
    """Run a stored query with `values` for its parameters; see `kg.query.core.run` for the rest."""
    terms = query.bind(values)
    return run(snapshot, query.text, parameters=terms, timeout=timeout, limit=limit, path=str(query.path))


def suggestion(
    snapshot: Snapshot, query: StoredQuery, values: Mapping[str, str], *, timeout: float | None = None
) -> str | None:
    """Return what was probably meant when a query with `values` found nothing.

    The query is asked again without each value in turn; when its column of that name does not have the value, the
    values alike that it has are suggested.
    """
    for name in values:
        terms = query.bind({key: value for key, value in values.items() if key != name})
        result = run(snapshot, query.text, parameters=terms, timeout=timeout, path=str(query.path))
        if not isinstance(result, Solutions) or name not in result.variables:
            continue
        column = result.variables.index(name)
        terms_found = (row[column] for row in result.rows)
        known = {term.value for term in terms_found if isinstance(term, Literal | NamedNode)}
        wanted = query.bind({name: values[name]})[name].value
        if wanted not in known:
            hint = did_you_mean(wanted, known)
            return f"there is no {name} `{wanted}`" + (f". {hint}" if hint else "")
    return None
